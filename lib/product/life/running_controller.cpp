#include "running_controller.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <utility>

#include <busbar/server/running_server.hpp>

#include "product/configuration/toml_reader.hpp"
#include "product/machine/ticker.hpp"
#include "startup.hpp"

namespace busbar::product {

namespace {

/// Interval between attempts to open the proper listeners.
constexpr std::chrono::seconds listening_period{5};
/// Interval for polling instructions of the program.
constexpr std::chrono::milliseconds instruction_period{20};

/// Delivers SIGHUP to the calling thread while this object exists, including one that was held
/// before.
class TakenHangups {
public:
    TakenHangups()
    {
        ::sigset_t hangup;
        ::sigemptyset(&hangup);
        ::sigaddset(&hangup, SIGHUP);
        ::pthread_sigmask(SIG_UNBLOCK, &hangup, &before_);
    }
    TakenHangups(const TakenHangups&) = delete;
    TakenHangups& operator=(const TakenHangups&) = delete;
    ~TakenHangups() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

private:
    ::sigset_t before_{};
};

} // namespace

void RunningController::restart_replaced()
{
    if (looks_until_restart_ > 0 && --looks_until_restart_ == 0) {
        start_again({.reason = "the controller's memory was replaced"});
    }
}

void RunningController::happen(HardwareEvent event)
{
    loop_.post([this, event] { follow(event); });
}

void RunningController::power_going()
{
    loop_.post([this] {
        if (machine_) {
            machine_->power_going();
        }
    });
}

void RunningController::reload()
{
    read_again_soon();
}

void RunningController::switch_mode(controller::MachineMode mode)
{
    loop_.post([this, mode] {
        if (machine_) {
            try_to([&] { expect(current_->switch_mode(mode)); });
        }
    });
}

std::optional<controller::PlcError> RunningController::plc_error() const
{
    return machine_ ? machine_->event_log().plc_error() : std::nullopt;
}

/// Posts the change: it must not happen in a callback, and applies to the server that serves then.
void RunningController::changed(Machine::Change change)
{
    if (machine_) {
        loop_.post([this, change] {
            machine_->changed(change, *current_->plant().program(),
                              current_->config().server.endpoint_url);
        });
    }
}

/// Lets clients see the reason, and an administrator start the server again.
void RunningController::follow(HardwareEvent event)
{
    if (!machine_) {
        return; // model mode has no life cycle that an event of the hardware could change
    }
    if (machine_->happen(event)) {
        log_.write(LogLevel::Error, "controller",
                   "the hardware has the OPC UA server halt, until a restart");
        halt("the hardware has the OPC UA server halt");
    }
    if (!machine_->life().has_program_going()) {
        current_->halt();
    }
}

void RunningController::stay_out()
{
    if (const std::string why = machine_->why_out(); !why.empty()) {
        halt(why);
    }
    if (!machine_->life().has_program_going()) {
        current_->halt();
    }
}

void RunningController::halt(const std::string& why, ServerState state)
{
    server::RunningServer{current_->server()}.change_state(state, why, {});
}

/// Ignores a generation that is being left, because clients can no longer ask it.
void RunningController::renewed()
{
    const auto& identity = current_->config().server.identity;
    if (identity_ && identity) { // a registration refers to it
        identity_ = identity;
    }
    ++renewals_;
}

void RunningController::try_to(FunctionRef<void()> change)
{
    try {
        change();
    } catch (const ConfigError& error) {
        log_.write(LogLevel::Error, "controller",
                   std::string{error.what()} + "; nothing was changed");
    }
}

namespace {

net::Handover handover_of(const administration::RestartWish& wish)
{
    return {.reason = wish.reason, .delay = wish.delay, .return_time = wish.return_time};
}

} // namespace

void RunningController::restart(const administration::RestartWish& wish)
{
    replace_soon([this, wish] {
        replace({.cause = Machine::Cause::Restart,
                 .handover = handover_of(wish),
                 .read = [this] { return read(configuration_, as_known()); },
                 .refused =
                     [this, wish](const ConfigError& error) {
                         if (is_out()) {
                             restart_with_last(wish, error.what());
                         }
                     }});
    });
}

/// Restarts as at a start: otherwise a server that is out would be lost to administrators far away.
void RunningController::restart_with_last(const administration::RestartWish& wish, std::string why)
{
    replace_soon([this, wish, refusal = std::move(why)] {
        replace({.cause = Machine::Cause::Restart,
                 .handover = handover_of(wish),
                 .read = [this] { return reading_of_last(); },
                 .done =
                     [this, refusal] {
                         const std::string text =
                             refusal + "; it goes on with what it ran with last";
                         log_.write(LogLevel::Error, "controller", text);
                         pending_.ask(PendingChanges::By::Start, text);
                         if (machine_) {
                             machine_->refuse_configuration(refusal);
                         }
                     },
                 .is_of_last = true});
    });
}

bool RunningController::is_out() const
{
    return machine_ ? !machine_->why_out().empty() : is_shut_down_;
}

Reading RunningController::reading_of_last()
{
    const TakenOver now = current_->taken_over();
    return read(configuration_,
                {SourceFiles{now.files}, now.project_text(), now.project != nullptr});
}

Substitutes RunningController::as_known() const
{
    return {.files = current_->sources().again(),
            .project = current_->project_document(),
            .running = current_->project()};
}

Reading RunningController::reading_for_restart()
{
    Reading next = read(configuration_, as_known());
    check_left_out(next.config);
    expect(check_listeners(next.config));
    return next;
}

std::function<Configured<void>()> RunningController::restart_check()
{
    try {
        const Reading next = reading_for_restart();
        return labels_check(next.project, next.config, current_->project_document());
    } catch (const ConfigError& error) {
        return [problem = error.problem()]() -> Configured<void> { return Unexpected{problem}; };
    }
}

std::function<Configured<void>()>
RunningController::labels_check(std::shared_ptr<const KeptProject> project,
                                const ControllerConfig& next, std::string last) const
{
    if (project == nullptr) {
        return [] { return Configured<void>{}; };
    }
    return [project = std::move(project), last = std::move(last),
            isolates = next.labels.isolates_failures,
            labels = labels_ ? labels_->labels_with(next) : [all = this->labels()] {
                return std::shared_ptr<const backend::LabelBackend>{all};
            }]() -> Configured<void> {
        try {
            return project->is_known(last) ? Configured<void>{}
                                           : project->check_labels(*labels(), isolates);
        } catch (const ConfigError& error) {
            return Unexpected{error.problem()};
        }
    };
}

void RunningController::keep()
{
    const std::string& place = current_->config().certificates.folder;
    if (!kept_folder_ || kept_folder_->place("") != storage::FolderStorage{place}.place("")) {
        kept_.emplace(kept_folder_.emplace(place));
    }
    TakenOver now = current_->taken_over();
    if (!listening_.is_elsewhere()) {
        now.listeners = listening_.told();
    }
    is_keeping_due_ = false;
    const auto kept = kept_->keep(now);
    const std::string why_not = kept ? std::string{} : text(kept.error());
    const std::string before = std::exchange(why_not_kept_, why_not);
    if (!kept && why_not != before) {
        log_.write(LogLevel::Warning, "controller",
                   "what runs cannot be kept for the next start: " + why_not);
    } else if (kept && !before.empty()) {
        log_.write(LogLevel::Info, "controller", "what runs is kept for the next start");
    }
}

/// A project of some megabytes takes its time, and so does what has just been done.
void RunningController::keep_soon()
{
    is_keeping_due_ = true;
    loop_.post([this] {
        if (is_keeping_due_) {
            store_again();
        }
    });
}

void RunningController::store_again()
{
    if (starts_again_ || looks_until_restart_ > 0) {
        return; // the present files count, not what runs
    }
    static_cast<void>(put_back());
    if (is_keeping_due_ || !why_not_kept_.empty()) {
        keep();
    }
}

Configured<void> RunningController::check_listeners(const ControllerConfig& next) const
{
    return next.machine.is_used ? listening_.check(listeners_of(next)) : Configured<void>{};
}

void RunningController::save_retained()
{
    if (machine_) {
        machine_->save_retained();
    }
}

void RunningController::start()
{
    if (machine_) {
        machine_->keep(*current_->plant().program());
    }
    current_->start();
    instructions_.reset();
    if (machine_ && std::ranges::any_of(current_->config().plc.programs, [](const auto& each) {
            return each.kind == controller::PlcProgramKind::Shutdown;
        })) {
        instructions_.emplace([this] {
            loop_.post([this] { serve_instructions(); });
            return instruction_period;
        });
    }
}

void RunningController::serve_instructions()
{
    if (machine_->serve(current_->plant().plc().instructions())) {
        halt("the controller's program has shut the OPC UA server down");
        loop_.unregister();
    }
}

/// Starts with other listeners or another machine; the present machine must release its logs first.
void RunningController::start_again(const net::Handover& handover)
{
    const bool begins = server::RunningServer{current_->server()}.begin_shutdown(
        handover.reason, handover.delay, handover.return_time);
    if (begins) {
        starts_again_ = true;
        loop_.stop();
    }
}

/// Handles SIGHUP. A failure changes nothing and is logged. If the signal came because the terminal
/// was closed, the controller ends, as other programs do.
void RunningController::hang_up()
{
    if (has_terminal_ && !has_terminal()) {
        loop_.stop();
        return;
    }
    read_again_soon();
}

void RunningController::read_again(const std::optional<PreparedProgram>& program)
{
    try_to_read([&] {
        if (!machine_ || !download(program)) {
            read_files_again();
        }
    });
}

void RunningController::try_to_read(FunctionRef<void()> act)
{
    try_to([&] {
        try {
            act();
        } catch (const ConfigError& error) {
            pending_.ask(PendingChanges::By::Reload, error.what());
            throw;
        }
    });
}

void RunningController::read_files_again()
{
    const std::string found = current_->reload();
    keep();
    pending_.done(PendingChanges::By::Reload);
    look_soon();
    if (!pending_.has(PendingChanges::By::Start)) {
        log_.write(LogLevel::Info, "controller", found);
        return;
    }
    work_aside([this, check = restart_check(), found] {
        const bool is_usable = check().has_value();
        loop_.post([this, is_usable, found] {
            if (is_usable) {
                end_refusal();
            }
            log_.write(LogLevel::Info, "controller", found);
        });
    });
}

void RunningController::end_refusal()
{
    pending_.done(PendingChanges::By::Start);
    if (machine_) {
        machine_->refuse_configuration({});
    }
}

void RunningController::work_aside(const std::function<void()>& work)
{
    if (!maker_->run(work)) {
        work();
    }
}

void RunningController::look_soon()
{
    loop_.post([this] { current_->look(); });
}

bool RunningController::run()
{
    if (labels_) {
        labels_->start();
    }
    if (field_labels_) {
        field_labels_->start(loop_);
    }
    start();
    if (takes_signals_) {
        loop_.stop_on_signals([this] {
            if (machine_) {
                machine_->power_going();
            }
        });
        loop_.on_hangup([this] { hang_up(); });
    }
    if (greets_) {
        current_->print_welcome();
    }
    if (machine_ && !listening_.is_halted()) {
        machine_->run(*current_->plant().program(), current_->config().server.endpoint_url,
                      current_->plant().plc().instructions());
    }
    if (machine_ && !refused_.empty()) { // a start before would end the error
        machine_->refuse_configuration(refused_);
    }
    keep();
    const Ticker lookouts{[this] {
        look_soon();
        return lookout_period;
    }};
    const Ticker attempts{[this] {
        loop_.post([this] {
            listen_as_told();
            restart_replaced();
            store_again();
        });
        return listening_period;
    }};
    {
        std::optional<TakenHangups> taken;
        if (takes_signals_) {
            taken.emplace();
        }
        loop_.run(current_->server());
    }
    drop_next();
    store_again();
    current_->halt();
    if (field_labels_) {
        field_labels_->stop();
    }
    if (machine_) {
        machine_->shut_down();
    }
    if (greets_) {
        current_->print_statistics();
        std::puts(starts_again_ ? "starting again" : "stopped");
        std::fflush(stdout);
    }
    return starts_again_;
}

} // namespace busbar::product

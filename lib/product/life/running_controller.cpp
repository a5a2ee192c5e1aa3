#include "running_controller.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include <busbar/client/registration.hpp>
#include <busbar/server/running_server.hpp>

#include "listening.hpp"
#include "product/configuration/toml_reader.hpp"
#include "product/machine/ticker.hpp"
#include "startup.hpp"

namespace busbar::product {

namespace {

/// Interval between attempts to open the proper listeners.
constexpr std::chrono::seconds listening_period{5};
/// Interval for polling instructions of the program.
constexpr std::chrono::milliseconds instruction_period{20};

bool has_terminal()
{
    const int terminal = ::open("/dev/tty", O_RDWR | O_NOCTTY | O_CLOEXEC);
    return terminal >= 0 && ::close(terminal) == 0;
}

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

Standing standing_of(const ControllerConfig& config)
{
    Standing standing{.is_used = config.machine.is_used,
                      .reverse_urls = config.reverse_urls,
                      .discovery = config.discovery,
                      .application_uri = {},
                      .key_log = config.key_log};
    if (!config.discovery.url.empty()) {
        ControllerConfig named = config;
        set_names(named);
        standing.application_uri = named.server.application_uri;
    }
    return standing;
}

RunningController::RunningController(Configuration configuration, Beginning beginning,
                                     Runtime& runtime, LogSink& log,
                                     const ControllerOptions& options)
    : configuration_{std::move(configuration)}, runtime_{runtime}, log_{log},
      takes_signals_{options.takes_signals}, greets_{options.greets},
      listening_{loop_, listeners_of(beginning.reading.config)}, has_terminal_{has_terminal()}
{
    Reading& reading = beginning.reading;
    ControllerConfig& config = reading.config;
    if (config.machine.program) {
        machine_.emplace(config, runtime_.medium(), clock_, log_, [this](bool is_in) {
            loop_.post([this, is_in] { machine_->medium_is(is_in); });
        });
    }
    refuse_beginning(beginning);
    if (reading.project != nullptr && runtime_.labels() == nullptr) {
        if (!runtime_.is_simulated()) {
            throw ConfigError{configuration_.project,
                              "found a project, and this PLC has no labels"};
        }
        labels_.emplace(config, clock_);
    }
    if (beginning.last && !beginning.last->project.empty()) {
        expect(check_labels(reading.project.get(), config, beginning.last->project));
    }
#ifdef BUSBAR_KEY_LOG
    if (!config.key_log.empty()) {
        key_log_ = expect(net::KeyLogFile::open(config.key_log, log_), config.key_log);
    }
#endif
    standing_ = standing_of(config);
    make_missing_certificate(config, clock_.now(), machine_ ? machine_->log() : log_);
    listen(config, beginning.last ? beginning.last->listeners : Listening::Listeners{});
    listening_.set_in(config);
    runtime_use_.emplace(runtime_, static_cast<RuntimeHost&>(*this));
    current_ = std::make_unique<Generation>(configuration_, std::move(reading), surroundings(),
                                            requests());
    current_->prepare();
    current_->finish();
    clients_.use(current_->clients());
    identity_ = current_->config().server.identity;
    register_with_discovery_server(current_->config());
}

void RunningController::refuse_beginning(const Beginning& beginning)
{
    const auto& [reading, last, refusal, damage] = beginning;
    if (refusal.empty() && damage.empty()) {
        return;
    }
    const std::string more = refusal.empty() || damage.empty() ? damage : "; " + damage;
    const std::string text =
        refusal.empty() ? damage : refusal + "; it begins with what it ran with last" + more;
    log_.write(LogLevel::Error, "controller", text);
    pending_.ask(PendingChanges::By::Start, text);
    refused_ = refusal + more;
}

/// Listens for clients, and connects to those that wait for a connection.
void RunningController::listen(const ControllerConfig& config, Listening::Listeners last)
{
    if (!config.machine.is_used) {
        return;
    }
    if (const auto begun = listening_.begin(); !begun) {
        if (last.empty() && !machine_) {
            throw ConfigError{begun.error()}; // it never served anybody, and no program goes on
        }
        const std::string why = text(begun.error());
        expect(listening_.begin_elsewhere(std::move(last)));
        if (listening_.is_halted() && machine_) {
            machine_->cannot_start(why);
        }
        const std::string what =
            why +
            (listening_.is_halted()
                 ? "; the server halts, and administrators reach it at this machine"
                 : "; it listens where it did last") +
            ", on port " + std::to_string(listening_.port()) + ", until it can";
        log_.write(LogLevel::Error, "controller", what);
        pending_.ask(PendingChanges::By::Listeners, what);
    }
    net::ReverseConnectConfig reverse;
    reverse.client_urls = config.reverse_urls;
    expect(loop_.connect_to_clients(reverse), "connecting to clients");
}

void RunningController::listen_as_told()
{
    const bool is_shut_down =
        machine_ && machine_->life().operating_status() == controller::OperatingStatus::Shutdown;
    if (is_shut_down || !listening_.can_go_as_told() || next_ != nullptr) {
        return;
    }
    try_to([&] {
        expect(listening_.go_as_told());
        replace({.cause = Machine::Cause::Restart,
                 .handover = {.reason = "it can listen where it is told to"},
                 .read =
                     [this] {
                         const TakenOver now = current_->taken_over(); // nothing else is taken up
                         return read(configuration_,
                                     {SourceFiles{now.files}, now.project, !now.project.empty()});
                     },
                 .done =
                     [this] {
                         listening_.stay();
                         pending_.done(PendingChanges::By::Listeners);
                     },
                 .refused = [this](const ConfigError&) { listening_.go_back(); }});
    });
}

void RunningController::restart_replaced()
{
    if (looks_until_restart_ > 0 && --looks_until_restart_ == 0) {
        start_again({.reason = "the controller's memory was replaced"});
    }
}

void RunningController::register_with_discovery_server(const ControllerConfig& config)
{
    if (config.discovery.url.empty() || !config.machine.is_used) {
        return;
    }
    client::SecurityWishes wishes;
    wishes.min_mode = MessageSecurityMode::Sign;
    wishes.allows_none = config.discovery.allows_none;
    net::DiscoveryRegistrationConfig registration;
    registration.client = client::registration_client(
        config.discovery.url, wishes, config.server.application_uri, identity_.has_value());
    registration.settings = net::registration_of(config.server, {config.server.endpoint_url});
    registration.settings.interval = config.discovery.interval;
    const channel::ChannelEnvironment environment{.random = &random_,
                                                  .wall_clock = &clock_,
                                                  .log = &log_,
                                                  .validator = &clients_,
                                                  .identity = identity_ ? &*identity_ : nullptr};
    expect(loop_.register_with(std::move(registration), environment),
           "registering with " + config.discovery.url);
}

Surroundings RunningController::surroundings()
{
    server::ServerEnvironment environment{
        .random = &random_, .wall_clock = &clock_, .waker = &loop_.waker()};
#ifdef BUSBAR_KEY_LOG
    environment.key_log = key_log_.get();
#endif
    return {.environment = environment,
            .lines = log_,
            .runtime = runtime_,
            .machine = machine_ ? &*machine_ : nullptr,
            .labels = labels_ ? labels_->labels() : runtime_.labels(),
            .label_priority = labels_ ? labels_->task_priority() : 0,
            .port = listening_.port(),
            .pending = pending_};
}

Requests RunningController::requests()
{
    return {
        .stop = [this] { loop_.stop(); },
        .start_over =
            [this] {
                starts_again_ = true;
                loop_.stop();
            },
        .shut_down =
            [this](const std::string& reason) {
                machine_->shut_server_down(reason);
                loop_.unregister();
            },
        .restart = [this](const administration::RestartWish& wish) { restart(wish); },
        .renewed =
            [this] {
                renewed();
                changed(&controller::LifeCycle::certificate_renewed);
            },
        .security_changed = [this] { changed(&controller::LifeCycle::security_changed); },
        .address_changed = [this] { changed(&controller::LifeCycle::address_changed); },
        .hardware = [this](HardwareEvent event) { happen(event); },
        .memory_replaced =
            [this] {
                loop_.post([this] {
                    if (machine_->memory_replaced()) {
                        halt("the controller's memory was replaced, and it is to be restarted",
                             ServerState::Suspended);
                    }
                    looks_until_restart_ = 2; // the client is answered first
                });
            },
        .may_restart = [this] { return may_restart(false); },
        .may_update = [this] { return may_restart(true); },
        .check_listeners = [this](const ControllerConfig& next) { return check_listeners(next); },
        .settings_changed = [this] { loop_.post([this] { keep(); }); },
        .change_program = [this](const ProgramChange& change) { return change_program(change); }};
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
    when_free([this] { read_again(); });
}

void RunningController::switch_mode(controller::MachineMode mode)
{
    loop_.post([this, mode] {
        if (machine_) {
            try_to([&] { expect(current_->set_mode(mode)); });
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

void RunningController::restart(const administration::RestartWish& wish)
{
    when_free([this, wish] {
        replace({.cause = Machine::Cause::Restart,
                 .handover = {.reason = wish.reason,
                              .delay = wish.delay,
                              .return_time = wish.return_time},
                 .read = [this] { return read(configuration_, as_known()); }});
    });
}

Substitutes RunningController::as_known() const
{
    return {.files = current_->sources().again(),
            .project = current_->project_document(),
            .running = current_->project()};
}

Configured<void> RunningController::may_restart(bool are_labels_checked)
{
    try {
        const Reading next = read(configuration_, as_known());
        return check_listeners(next.config).and_then([&] {
            return are_labels_checked ? Configured<void>{}
                                      : check_labels(next.project.get(), next.config,
                                                     current_->project_document());
        });
    } catch (const ConfigError& error) {
        return Unexpected{error.problem()};
    }
}

Configured<void> RunningController::check_labels(const KeptProject* project,
                                                 const ControllerConfig& next,
                                                 const std::string& last) const
{
    if (project == nullptr || project->is_known(last)) {
        return {};
    }
    const std::shared_ptr<const backend::LabelBackend> labels =
        labels_ ? labels_->labels_with(next) : runtime_.labels();
    return project->check_labels(*labels, next.labels.isolates_failures);
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
    if (const auto kept = kept_->keep(now); !kept) {
        log_.write(LogLevel::Warning, "controller",
                   "what runs cannot be kept for the next start: " + text(kept.error()));
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
    when_free([this] { read_again(); });
}

void RunningController::read_again()
{
    try_to([this] {
        try {
            if (machine_ && download()) {
                return;
            }
            download_labels();
            log_.write(LogLevel::Info, "controller", current_->reload());
            keep();
        } catch (const ConfigError& error) {
            pending_.ask(PendingChanges::By::Reload, error.what());
            throw;
        }
        pending_.done(PendingChanges::By::Reload);
        look_soon();
        if (pending_.has(PendingChanges::By::Start) && may_restart(false)) {
            pending_.done(PendingChanges::By::Start);
            if (machine_) {
                machine_->refuse_configuration({});
            }
        }
    });
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
    current_->halt();
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

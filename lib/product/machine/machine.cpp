#include "machine.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <initializer_list>
#include <utility>

#include <busbar/core/record.hpp>
#include <busbar/core/status_codes.hpp>

#include "core/unfinished.hpp"
#include "machine_retained.hpp"
#include "product/access/part_rights.hpp"

namespace busbar::product {

namespace {

/// The execution log has at most 100 files (W588, 7-1-5).
constexpr std::size_t most_log_entries = 1'000;
/// The execution log always has room for the Preparing of a program with so many variables (W588,
/// 1-2-2).
constexpr std::size_t usual_variables = 10'000;

// Of the saver.
constexpr std::chrono::milliseconds usual_pause{200};
constexpr std::chrono::milliseconds pause_after_error{3'000};

controller::ServerSettings settings_of(const ControllerConfig& config)
{
    controller::ServerSettings settings;
    settings.is_used = config.machine.is_used;
    settings.port = config.port;
    settings.execution_log = config.machine.execution_log;
    return settings;
}

void make_root(Storage& folder)
{
    const auto made = folder.make_folder("", FileAccess::Owner);
    if (!made && made.error() != StorageError::Away) {
        throw ConfigError{folder.place(""), std::string{text(made.error())}};
    }
}

} // namespace

Machine::Machine(const ControllerConfig& config, const StorageMedium* card, const WallClock& clock,
                 LogSink& lines, MediumFound medium_found)
    : config_{config.machine}, files_folder_{config.certificates.folder},
      max_variables_{std::max(usual_variables, config.machine.program->program().variables.size())},
      settings_{settings_of(config)}, state_{config.machine.state_folder},
      medium_{config.machine.medium_folder, card},
      event_files_{state_, controller::MachineEventLogOptions{}.folder}, events_{lines},
      log_folder_{medium_, controller::ExecutionLogOptions{}.folder}, medium_found_{
                                                                          std::move(medium_found)}
{
    make_root(state_);
    if (medium_.is_configured() && config_.makes_medium) {
        make_root(medium_);
    }
    busbar::detail::remove_unfinished_below(state_, "");
    // Create the event log after the execution log, which reports to it what cannot be saved.
    event_log_ = expect(controller::MachineEventLog::create(
        state_, clock, lines, &events_, {.levels = config.machine.event_levels}));
    if (config.machine.execution_log.is_recorded) {
        controller::ExecutionLogOptions options;
        options.max_files = config.machine.execution_log.files;
        options.max_records = config.machine.execution_log.records;
        // Let one whole Preparing of this program wait.
        options.max_waiting += max_variables_;
        execution_log_ =
            expect(controller::ExecutionLog::create(medium_, clock, *event_log_, options));
        log_folder_.set_log(*execution_log_);
    }
    retained_.emplace(state_, log(), config.machine.retained);
    life_ = std::make_unique<controller::LifeCycle>(static_cast<controller::ServerOperator&>(*this),
                                                    clock, log());
    saver_.emplace([this] { return save_pending() ? usual_pause : pause_after_error; });
    life_->mode_changed(config.machine.mode);
    life_->power_on();
}

Machine::~Machine()
{
    saver_.reset();
}

bool Machine::save_pending()
{
    const std::lock_guard lock{saving_};
    const bool is_retained = retained_->save_when_due(std::chrono::steady_clock::now());
    const bool is_kept = event_log_->write_pending().has_value() && is_retained;
    bool is_logged = true;
    if (execution_log_) {
        look_for_medium();
        is_logged = save_records();
    }
    look_for_log_files();
    return is_logged && is_kept;
}

void Machine::look_for_medium()
{
    const auto space = medium_.free_space();
    const bool is_there = space || space.error() != StorageError::Away;
    was_medium_there_ = was_medium_there_ || is_there;
    if (is_there != is_medium_there_) {
        is_medium_there_ = is_there;
        medium_found_(is_there);
    }
}

/// Saves records. Waiting for a medium is not an error; the medium is not tried before the life
/// cycle knows that it is present.
bool Machine::save_records()
{
    if (!was_medium_there_) { // since the start: that is an event (W588, 7-4-1)
        return execution_log_->write_pending().has_value();
    }
    const bool is_in = is_medium_in_;
    if (is_in != is_medium_used_) {
        is_medium_used_ = is_in;
        tell_log_of_medium(is_in);
    }
    if (is_in && !is_medium_there_) {
        return true;
    }
    return execution_log_->write_pending().has_value() || !is_in;
}

void Machine::tell_log_of_medium(bool is_in)
{
    if (is_in || !is_medium_there_) {
        execution_log_->medium_changed(is_in ? controller::LogMedium::In
                                             : controller::LogMedium::Out);
    } else { // before the medium is taken out it gets what waits (W588, 7-4-3)
        static_cast<void>(execution_log_->release_medium());
    }
}

void Machine::look_for_log_files()
{
    // A file that was removed and started again has the same name.
    if (log_folder_.take_removal()) {
        log_files_.clear();
    }
    std::vector<std::string> names;
    for (Storage* const folder : std::initializer_list<Storage*>{&log_folder_, &event_files_}) {
        const auto listing = folder->list("", most_log_entries);
        if (!listing && listing.error() != StorageError::NotFound) {
            return; // files that cannot be listed now are not gone
        }
        if (listing) {
            for (const StorageEntry& entry : listing->entries) {
                names.push_back(entry.name);
            }
        }
    }
    if (names != log_files_) {
        log_files_ = std::move(names);
        has_changed_files_ = true;
    }
}

std::vector<administration::FileSystem> Machine::file_systems()
{
    const auto folder = [](AdministeredPart part, Storage& files) {
        const PartRight& right = right_of(part);
        return administration::FileSystem{.name = std::string{right.name},
                                          .storage = &files,
                                          .readers = nodes_of(right.see),
                                          .writers = nodes_of(right.change)};
    };
    administration::FileSystem events = folder(AdministeredPart::EventLog, event_files_);
    administration::FileSystem log = folder(AdministeredPart::ExecutionLog, log_folder_);
    log.is_written_by_program = true;
    log.limits.max_entries = most_log_entries;
    log.limits.max_depth = 1;
    events.is_written_by_program = true;
    events.limits = log.limits;
    log.may_delete = controller::ExecutionLog::is_complete_file;
    log.begin_new_file = [this] { return execution_log_->begin_new_file(); };
    return execution_log_ ? std::vector{log, events} : std::vector{events};
}

void Machine::keep(const MachineProgram& program)
{
    storage::FolderStorage files{files_folder_};
    if (const auto taken = take_up_values(files, state_); !taken) {
        log().write(LogLevel::Error, "controller",
                    "values of RETAIN variables cannot be restored: " + text(taken.error()));
    }
    retained_->keep(program);
}

void Machine::hold_files(FunctionRef<void()> act)
{
    const std::lock_guard lock{saving_};
    // Records that cannot be saved now are missing in the backup; that does not stop it.
    static_cast<void>(event_log_->write_pending());
    static_cast<void>(retained_->save());
    act();
}

bool Machine::memory_replaced()
{
    const auto before = life_->operating_status();
    is_memory_replaced_ = true;
    life_->restore_begins();
    life_->restore_done(true);
    return has_left_running(before);
}

bool Machine::serve(controller::InstructionDesk& desk)
{
    const auto before = life_->operating_status();
    desk.serve(*life_, log());
    return has_left_running(before);
}

bool Machine::has_left_running(controller::OperatingStatus before) const
{
    return before == controller::OperatingStatus::Running &&
           life_->served_clients() != controller::ServedClients::All;
}

void Machine::refuse_configuration(std::string_view why)
{
    const std::array fields{RecordField{"Reason", Variant{String{std::string{why}}}}};
    Record record;
    record.kind = RecordKind::ConfigurationRefused;
    record.level = LogLevel::Error;
    record.status = why.empty() ? status::Good : status::Bad_ConfigurationError;
    record.fields = fields;
    tell(log(), record);
}

LogSink& Machine::log()
{
    if (execution_log_) {
        return *execution_log_;
    }
    return *event_log_;
}

void Machine::run(MachineProgram& program, const std::string& endpoint_url,
                  controller::InstructionDesk& desk)
{
    events_.tell(&program.events());
    if (life_->operating_status() == controller::OperatingStatus::Initializing) {
        desk.serve(*life_, log());
        life_->initialized(settings_);
    }
    if (life_->operating_status() != controller::OperatingStatus::Preparing) {
        return; // the server is not used, or out until a restart
    }
    tell_program(program);
    life_->prepared(preparation_, endpoint_url);
}

void Machine::tell_program(const MachineProgram& program)
{
    program.tell_left_out(log());
    tell(log(), program.publication());
}

void Machine::save_retained()
{
    if (const auto saved = retained_->save(); !saved) {
        throw ConfigError{config_.state_folder, "values of RETAIN variables cannot be saved: " +
                                                    std::string{text(saved.error())}};
    }
}

bool Machine::fits(const ControllerConfig& config) const
{
    // The number of records that may wait depends on the program's size.
    return config.machine.program && config.machine.state_folder == config_.state_folder &&
           config.machine.medium_folder == config_.medium_folder &&
           config.machine.execution_log == config_.execution_log &&
           config.machine.retained == config_.retained &&
           config.machine.program->program().variables.size() <= max_variables_;
}

void Machine::replace(Cause cause, MachineProgram& program, const ControllerConfig& config,
                      controller::InstructionDesk& desk)
{
    is_memory_replaced_ = is_memory_replaced_ && cause != Cause::Restart;
    settings_ = settings_of(config);
    life_->mode_changed(config.machine.mode);
    if (cause == Cause::Download) {
        life_->download_begins();
        life_->download_done(settings_);
    } else {
        life_->reset();
    }
    run(program, config.server.endpoint_url, desk);
}

void Machine::changed(Change change, const MachineProgram& program, const std::string& endpoint_url)
{
    const std::uint32_t before = preparation_;
    (*life_.*change)();
    if (preparation_ != before) {
        tell_program(program);
        life_->prepared(preparation_, endpoint_url);
    }
}

Configured<void> Machine::edit(const MachineProgram& program, Adding add)
{
    adding_ = &add;
    life_->online_edit();
    adding_ = nullptr;
    const bool is_published = added_.has_value();
    if (!is_published && is_memory_replaced_) {
        return misconfigured("online edit",
                             "the controller's memory was replaced, and a restart is "
                             "due before",
                             status::Bad_InvalidState);
    }
    const auto added = is_published ? *std::exchange(added_, std::nullopt) : add();
    if (!added) {
        return Unexpected{added.error()};
    }
    retained_->keep(*added);
    if (is_published) {
        program.tell_left_out(log());
        tell(log(), program.publication(), added->group);
    }
    return {};
}

void Machine::add_variables()
{
    if (adding_ != nullptr) {
        added_ = (*adding_)();
    }
}

void Machine::cannot_start(const std::string& why)
{
    life_->initialized(settings_);
    life_->preparation_failed(preparation_, controller::PreparationFailure::Start, why);
    save_now();
}

void Machine::shut_server_down(const std::string& reason)
{
    static_cast<void>(life_->shut_down(reason));
}

std::string Machine::why_out() const
{
    if (life_->served_clients() == controller::ServedClients::All) {
        return {};
    }
    const std::string_view reason = life_->restart_reason();
    return reason.empty() ? life_->halt_reason() : std::string{reason};
}

void Machine::shut_down()
{
    static_cast<void>(life_->shut_down("the controller ends"));
    events_.tell(nullptr);
}

bool Machine::happen(HardwareEvent event)
{
    using controller::FaultOrigin;
    const auto before = life_->operating_status();
    switch (event) {
    case HardwareEvent::MajorFault:
        life_->major_fault();
        break;
    case HardwareEvent::PartialFault:
    case HardwareEvent::PartialServerFault:
        life_->partial_fault(event == HardwareEvent::PartialFault ? FaultOrigin::Elsewhere
                                                                  : FaultOrigin::OpcUaServer);
        break;
    case HardwareEvent::MinorFault:
    case HardwareEvent::MinorServerFault:
        life_->minor_fault(event == HardwareEvent::MinorFault ? FaultOrigin::Elsewhere
                                                              : FaultOrigin::OpcUaServer);
        break;
    case HardwareEvent::Watchdog:
        life_->watchdog();
        break;
    case HardwareEvent::MediumOut:
    case HardwareEvent::MediumIn:
        life_->medium_changed(event == HardwareEvent::MediumIn);
        break;
    case HardwareEvent::MediumWorn:
        tell_medium_worn();
        break;
    }
    return has_left_running(before);
}

void Machine::tell_medium_worn()
{
    constexpr auto level = controller::EventLevel::Observation;
    const std::array fields{RecordField{"Level", Variant{String{std::string{name(level)}}}},
                            RecordField{"Where", Variant{String{"storage medium"}}}};
    Record record;
    record.kind = RecordKind::MachineFault;
    record.level = LogLevel::Warning;
    record.source = "medium";
    record.text =
        "the medium is close to the end of its life, and should be replaced (W588, 7-4-5)";
    record.fields = fields;
    tell(log(), record);
}

void Machine::prepare(std::uint32_t number, const controller::ServerSettings&)
{
    preparation_ = number;
}

void Machine::reconfigure(std::uint32_t number, const controller::ServerSettings&,
                          const controller::StopNotice&)
{
    preparation_ = number;
}

void Machine::stop(const controller::StopNotice&)
{
    life_->stopped();
    save_now();
}

/// Lets the saver tell the log, which blocks while a medium is written to.
void Machine::medium_changed(bool is_in)
{
    if (execution_log_ && is_medium_in_.exchange(is_in) != is_in) {
        log().write(is_in ? LogLevel::Info : LogLevel::Warning, "execution log",
                    medium_.place("") + (is_in ? ": the medium is in again, and records are saved"
                                               : ": the medium is away, and records wait for it"));
    }
}

void Machine::save_now()
{
    // Failures are reported where they happen.
    static_cast<void>(retained_->save());
    if (execution_log_) {
        static_cast<void>(execution_log_->flush());
    }
    static_cast<void>(event_log_->write_pending());
}

} // namespace busbar::product

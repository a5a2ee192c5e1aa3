#include <busbar/controller/life_cycle.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <busbar/core/record.hpp>

#include "life_table.hpp"

namespace busbar::controller {

using detail::LifeAction;
using detail::LifeEvent;
using detail::LifePhase;

namespace {

constexpr std::string_view life_source = "life cycle";

// W588, 7-1-6, *1.
constexpr std::string_view configuration_error = "Configuration Error";
constexpr std::string_view start_error = "Server Start Error";
constexpr std::string_view system_error_reason = "OPC UA System Error";

constexpr const char* controller_unit = "CPU Unit";

std::string_view text_of(RecordKind kind)
{
    switch (kind) {
    case RecordKind::ServerStarted:
        return "the OPC UA server starts";
    case RecordKind::ServerPreparing:
        return "the OPC UA server is being prepared";
    case RecordKind::ServerRunning:
        return "the OPC UA server runs at ";
    case RecordKind::ServerShutDown:
        return "the OPC UA server is shut down";
    case RecordKind::ServerHalted:
        return "the OPC UA server halts: ";
    default:
        return "a fatal error in the OPC UA server: ";
    }
}

LogLevel level_of(RecordKind kind)
{
    return kind == RecordKind::ServerHalted || kind == RecordKind::ServerSystemError
               ? LogLevel::Error
               : LogLevel::Info;
}

} // namespace

LifeCycle::LifeCycle(ServerOperator& server, const WallClock& clock, LogSink& log,
                     const LifeCycleOptions& options)
    : server_{&server}, clock_{&clock}, log_{&log}, options_{options}, preparation_time_{
                                                                           options.preparation_time}
{
}

// The machine.

void LifeCycle::power_on()
{
    handle(LifeEvent::Restart, "the controller starts again");
}

void LifeCycle::reset()
{
    handle(LifeEvent::Restart, "the controller is reset");
}

void LifeCycle::power_going()
{
    server_->save_now();
}

void LifeCycle::medium_changed(bool is_in)
{
    server_->medium_changed(is_in);
}

void LifeCycle::major_fault()
{
    tell_cause(LifeEvent::MajorFault, controller_unit);
}

void LifeCycle::partial_fault(FaultOrigin origin)
{
    if (origin == FaultOrigin::OpcUaServer) {
        return system_error("a partial fault of the OPC UA server");
    }
    tell_cause(LifeEvent::PartialFault, controller_unit);
}

void LifeCycle::minor_fault(FaultOrigin origin)
{
    tell_cause(LifeEvent::MinorFault,
               origin == FaultOrigin::OpcUaServer ? "OPC UA Server" : controller_unit);
}

void LifeCycle::watchdog()
{
    tell_cause(LifeEvent::Watchdog, "CPU watchdog");
    handle(LifeEvent::Watchdog, "the controller's processor failed");
}

// The program and settings of the machine.

void LifeCycle::download_begins()
{
    handle(LifeEvent::Begins, "a project is downloaded to the controller");
}

void LifeCycle::download_done(const Configured<ServerSettings>& settings)
{
    if (!settings) {
        halt_reason_ = configuration_error;
        return handle(LifeEvent::Unreadable, text(settings.error()));
    }
    settings_ = *settings;
    handle(settings_.is_used ? LifeEvent::Used : LifeEvent::Unused,
           "the OPC UA server is no longer used");
}

void LifeCycle::online_edit()
{
    // The preparation may already have read the program.
    is_edited_ = phase_ == LifePhase::Preparing;
    handle(LifeEvent::Edited);
}

void LifeCycle::restore_begins()
{
    handle(LifeEvent::Begins, "a backup is restored to the controller");
}

void LifeCycle::restore_done(bool is_restored)
{
    if (is_restored) {
        is_replaced_ = true;
    }
    handle(is_restored ? LifeEvent::Replaced : LifeEvent::Kept,
           "a backup was restored: the controller is to be restarted");
}

Configured<void> LifeCycle::clear_begins()
{
    if (mode_ == MachineMode::Run) {
        return misconfigured("clear all memory", "found RUN mode, expected PROGRAM mode",
                             status::Bad_InvalidState);
    }
    handle(LifeEvent::Begins, "the controller's memory is cleared");
    return {};
}

void LifeCycle::clear_done(bool is_cleared)
{
    if (is_cleared) {
        is_replaced_ = is_replaced_ || settings_.is_used;
        settings_ = {};
    }
    handle(is_cleared ? LifeEvent::Replaced : LifeEvent::Kept,
           "the controller's memory was cleared: it is to be restarted");
}

void LifeCycle::address_changed()
{
    handle(LifeEvent::Changed, "the controller's address changes");
}

void LifeCycle::certificate_renewed()
{
    handle(LifeEvent::Changed, "the server has a new certificate");
}

void LifeCycle::security_changed()
{
    handle(LifeEvent::Changed, "the security settings change");
}

ShutdownAnswer LifeCycle::shutdown_answer() const
{
    switch (operating_status()) {
    case OperatingStatus::NotStarted:
        return ShutdownAnswer::NotStarted;
    case OperatingStatus::Initializing:
        return ShutdownAnswer::Initializing;
    case OperatingStatus::Shutdown:
        return ShutdownAnswer::ShutDown;
    case OperatingStatus::Preparing:
    case OperatingStatus::Running:
    case OperatingStatus::HaltError:
        break;
    }
    return ShutdownAnswer::Begun;
}

ShutdownAnswer LifeCycle::shut_down(std::string_view reason)
{
    const ShutdownAnswer answer = shutdown_answer();
    if (answer == ShutdownAnswer::Begun) {
        handle(LifeEvent::ShutDown, reason);
    }
    return answer;
}

void LifeCycle::system_error(std::string_view why)
{
    halt_reason_ = system_error_reason;
    handle(LifeEvent::SystemFailed, why);
}

// Answers of the ServerOperator.

void LifeCycle::initialized(const Configured<ServerSettings>& settings)
{
    if (phase_ != LifePhase::Initializing) {
        return;
    }
    if (!settings) {
        halt_reason_ = configuration_error;
        return handle(LifeEvent::Unreadable, text(settings.error()));
    }
    settings_ = *settings;
    is_replaced_ = false;
    handle(settings_.is_used ? LifeEvent::Used : LifeEvent::Unused);
}

void LifeCycle::prepared(std::uint32_t number, std::string_view endpoint_url)
{
    if (number != preparation_ || phase_ != LifePhase::Preparing) {
        return;
    }
    endpoint_url_ = endpoint_url;
    const std::int64_t ticks = clock_->now().ticks - preparation_began_.ticks;
    preparation_time_ = std::max(std::chrono::seconds{1},
                                 std::chrono::seconds{(ticks + DateTime::ticks_per_second - 1) /
                                                      DateTime::ticks_per_second});
    handle(LifeEvent::Prepared);
}

void LifeCycle::preparation_failed(std::uint32_t number, PreparationFailure failure,
                                   std::string_view why)
{
    if (number != preparation_ || phase_ != LifePhase::Preparing) {
        return;
    }
    if (failure == PreparationFailure::System) {
        return system_error(why);
    }
    halt_reason_ = failure == PreparationFailure::Settings ? configuration_error : start_error;
    handle(LifeEvent::StartFailed, why);
}

void LifeCycle::stopped()
{
    stops_ -= stops_ > 0 ? 1 : 0;
    if (stops_ == 0) {
        handle(LifeEvent::Stopped);
    }
}

// The present state.

OperatingStatus LifeCycle::operating_status() const
{
    return detail::facts_of(phase_).status;
}

ServedClients LifeCycle::served_clients() const
{
    return detail::facts_of(phase_).serves;
}

std::string LifeCycle::halt_reason() const
{
    return operating_status() == OperatingStatus::HaltError
               ? std::string{halt_reason_} + (halt_details_.empty() ? "" : ": ") + halt_details_
               : std::string{};
}

bool LifeCycle::has_stopped() const
{
    return phase_ == LifePhase::Stopped;
}

MachineStatus LifeCycle::status(const ConnectionCounts& counts) const
{
    return {settings_.is_used, operating_status(), endpoint_url_, counts};
}

std::string_view LifeCycle::restart_reason() const
{
    if (is_replaced_) {
        return "the controller's memory was restored or cleared";
    }
    if (!has_program_going_) {
        return "a fault has stopped the user program";
    }
    if (detail::facts_of(phase_).is_restart_due) {
        return operating_status() == OperatingStatus::HaltError
                   ? "a fatal error has stopped the OPC UA server"
                   : "the OPC UA server was shut down";
    }
    return phase_ == LifePhase::NotStarted && settings_.is_used
               ? "the OPC UA server is used from the next start on"
               : "";
}

// The table at work.

void LifeCycle::handle(LifeEvent event, std::string_view why)
{
    const detail::LifeStep* const step = detail::life_step(phase_, event);
    if (step == nullptr) {
        return;
    }
    phase_ = step->next;
    if (operating_status() == OperatingStatus::HaltError) {
        halt_details_ = why;
    }
    has_program_going_ = has_program_going_ ||
                         detail::facts_of(event).program == detail::CauseFacts::Program::Starts;
    if (step->action == LifeAction::Prepare || step->action == LifeAction::Reconfigure) {
        begin_preparation();
    }
    for (const detail::ToldRecord& each : detail::told_records) {
        if ((step->records & each.bit) != 0) {
            tell_record(each.kind, why);
        }
    }
    act(step->action, event, why);
}

void LifeCycle::tell_record(RecordKind kind, std::string_view why)
{
    Record record;
    record.kind = kind;
    record.level = level_of(kind);
    record.source = life_source;
    record.text = text_of(kind);
    std::array<RecordField, 1> field;
    if (kind == RecordKind::ServerRunning) {
        record.text += endpoint_url_;
        field = {RecordField{"EndpointUrl", Variant{String{endpoint_url_}}}};
        record.fields = field;
    } else if (kind == RecordKind::ServerHalted) {
        record.text += std::string{halt_reason_} + (why.empty() ? "" : ": ") + std::string{why};
        field = {RecordField{"Reason", Variant{String{std::string{halt_reason_}}}}};
        record.fields = field;
    } else if (kind == RecordKind::ServerSystemError) {
        record.text += why;
    }
    tell(*log_, record);
}

void LifeCycle::tell_cause(LifeEvent event, std::string_view where)
{
    const detail::CauseFacts facts = detail::facts_of(event);
    has_program_going_ = has_program_going_ && facts.program != detail::CauseFacts::Program::Stops;
    const std::array fields{RecordField{"Level", Variant{String{std::string{facts.fault}}}},
                            RecordField{"Where", Variant{String{std::string{where}}}}};
    Record record;
    record.kind = RecordKind::MachineFault;
    record.level = LogLevel::Error;
    record.source = life_source;
    record.text = std::string{facts.fault} + " of the controller: " + std::string{where};
    record.fields = fields;
    tell(*log_, record);
}

/// Does the last step of an event: the operator may answer at once.
void LifeCycle::act(LifeAction action, LifeEvent event, std::string_view why)
{
    switch (action) {
    case LifeAction::None:
        return;
    case LifeAction::Initialize:
        return server_->initialize();
    case LifeAction::Prepare:
        return server_->prepare(preparation_, settings_);
    case LifeAction::Reconfigure:
        return server_->reconfigure(preparation_, settings_, {why, return_time({})});
    case LifeAction::Run:
        return run();
    case LifeAction::Suspend:
        return server_->suspend({why, return_time(options_.download_time)});
    case LifeAction::Stop:
        ++stops_;
        return server_->stop({why, event == LifeEvent::Restart ? return_time({}) : DateTime{}});
    case LifeAction::AddVariables:
        return server_->add_variables();
    }
}

void LifeCycle::begin_preparation()
{
    ++preparation_;
    preparation_began_ = clock_->now();
    is_edited_ = false;
}

void LifeCycle::run()
{
    server_->run();
    if (is_edited_ && phase_ == LifePhase::Running) {
        is_edited_ = false;
        server_->add_variables();
    }
}

DateTime LifeCycle::return_time(std::chrono::seconds more) const
{
    return {clock_->now().ticks + (preparation_time_ + more).count() * DateTime::ticks_per_second};
}

} // namespace busbar::controller

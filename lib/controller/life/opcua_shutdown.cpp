#include <busbar/controller/opcua_shutdown.hpp>

#include <string>
#include <string_view>

#include <busbar/controller/life_cycle.hpp>
#include <busbar/controller/machine_event_log.hpp>
#include <busbar/core/record.hpp>

namespace busbar::controller {

namespace {

constexpr const char* instruction_name = "OPCUA_Shutdown";

std::string_view text_of_code(std::uint16_t code)
{
    switch (code) {
    case InstructionDesk::too_many:
        return "too many instructions are executed at the same time";
    case static_cast<std::uint16_t>(ShutdownAnswer::ShutDown):
        return "the OPC UA server is shut down or is shutting down";
    case static_cast<std::uint16_t>(ShutdownAnswer::Initializing):
        return "the OPC UA server is being initialized";
    default:
        return "the OPC UA server is not started";
    }
}

void tell_failed(LogSink& log, std::uint16_t code)
{
    const std::array fields{RecordField{"Code", Variant{code}},
                            RecordField{"Instruction", Variant{String{instruction_name}}}};
    Record record;
    record.kind = RecordKind::InstructionFailed;
    record.level = LogLevel::Warning;
    record.source = "plc";
    record.text = std::string{instruction_name} + " failed: " + std::string{text_of_code(code)};
    record.fields = fields;
    tell(log, record);
}

} // namespace

std::size_t InstructionDesk::take_place()
{
    for (std::size_t place = 0; place < places; ++place) {
        std::uint32_t expected = Free;
        if (states_[place].compare_exchange_strong(expected, Requested)) {
            return place;
        }
    }
    turned_away_.fetch_add(1);
    return places;
}

void InstructionDesk::serve(LifeCycle& life, LogSink& log)
{
    for (std::atomic<std::uint32_t>& state : states_) {
        if (state.load() != Requested) {
            continue;
        }
        const ShutdownAnswer answer = life.shut_down("the controller's program ends the server");
        const auto code = static_cast<std::uint16_t>(answer);
        std::uint32_t expected = Requested;
        const std::uint32_t next = answer == ShutdownAnswer::Begun ? Accepted : Failed + code;
        // An instance that is gone by now gets no answer.
        if (state.compare_exchange_strong(expected, next) && next != Accepted) {
            tell_failed(log, code);
        }
    }
    // Also after a reset in between: the server was shut down for it.
    if (life.has_stopped() || life.operating_status() != OperatingStatus::Shutdown) {
        for (std::atomic<std::uint32_t>& state : states_) {
            std::uint32_t expected = Accepted;
            state.compare_exchange_strong(expected, Finished);
        }
    }
    for (const std::uint32_t now = turned_away_.load(); told_ != now; ++told_) {
        tell_failed(log, too_many);
    }
}

std::optional<PlcError> InstructionDesk::plc_error() const
{
    return errors_ != nullptr ? errors_->plc_error() : std::nullopt;
}

OpcuaShutdown::~OpcuaShutdown()
{
    if (busy()) {
        desk_->states_[place_].store(InstructionDesk::Free);
    }
}

void OpcuaShutdown::operator()(bool execute)
{
    const bool is_edge = execute && !was_executed_;
    was_executed_ = execute;
    if (busy()) {
        return look();
    }
    if (is_edge) {
        return start();
    }
    if (!execute) {
        is_done_ = false;
        error_id_ = 0;
    }
}

void OpcuaShutdown::start()
{
    is_done_ = false;
    place_ = desk_->take_place();
    error_id_ = busy() ? 0 : InstructionDesk::too_many;
}

void OpcuaShutdown::look()
{
    std::atomic<std::uint32_t>& state = desk_->states_[place_];
    const std::uint32_t found = state.load();
    if (found == InstructionDesk::Requested || found == InstructionDesk::Accepted) {
        return;
    }
    is_done_ = found == InstructionDesk::Finished;
    error_id_ = is_done_ ? 0 : static_cast<std::uint16_t>(found & 0xFFFFU);
    state.store(InstructionDesk::Free);
    place_ = InstructionDesk::places;
}

} // namespace busbar::controller

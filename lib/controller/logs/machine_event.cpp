#include <busbar/controller/machine_event.hpp>

#include <algorithm>
#include <array>

namespace busbar::controller {

namespace {

constexpr auto minor = EventLevel::MinorFault;
constexpr auto observation = EventLevel::Observation;
constexpr auto information = EventLevel::Information;

/// Levels are those of seed 000, 9-2-2; the columns of 9-2-1 have slipped in some rows.
constexpr std::array event_types{
    MachineEventType{0x15000000, "Execution Log Save Failed", minor, observation,
                     EventEnd::Automatic},
    MachineEventType{0x15020000, "Server Certificate Mismatch", observation, {}, EventEnd::Renewal},
    MachineEventType{0x35D00000, "OPC UA Server Setting Error", minor, {}, EventEnd::Automatic},
    MachineEventType{0x35D10000, "Server Certificate Expired", minor, observation,
                     EventEnd::Automatic},
    MachineEventType{0x35D20000, "Server Certificate Expiration Notice", observation, minor,
                     EventEnd::Renewal},
    MachineEventType{
        0x35D30000, "Too Many Public Variables", observation, {}, EventEnd::Preparation},
    MachineEventType{0x35D40000, "Unsupported Data Type", observation, {}, EventEnd::Preparation},
    MachineEventType{
        0x35D50000, "Too Many Public Value Attributes", observation, {}, EventEnd::Preparation},
    MachineEventType{
        0x35D60000, "Too Many Structure Definitions", observation, {}, EventEnd::Preparation},
    MachineEventType{0x44180000, "OPC UA System Processing Error", minor, {}, EventEnd::Restart},
    MachineEventType{
        0x85600000, "OPC UA Client Connection Rejected", observation, {}, EventEnd::Never},
    MachineEventType{0x95D00000, "OPC UA Server Started", information, {}, EventEnd::Never},
    MachineEventType{0x95D10000, "OPC UA Server Stopped", information, {}, EventEnd::Never},
    MachineEventType{0x95D20000, "Server Certificate Generated", information, {}, EventEnd::Never},
    MachineEventType{0x95D30000, "Client Certificate Discarded", information, {}, EventEnd::Never},
    MachineEventType{0x95D40000,
                     "OPC UA Server Certificate and Security Profile Cleared",
                     information,
                     {},
                     EventEnd::Never},
    MachineEventType{
        0x54015000, "OPC UA Server Shutdown or Shutting Down", observation, {}, EventEnd::Never},
    MachineEventType{
        0x54015001, "OPC UA Server Being Initialized", observation, {}, EventEnd::Never},
    MachineEventType{0x54015002, "OPC UA Server Not Started", observation, {}, EventEnd::Never},
    MachineEventType{0, "Client Certificate Expired", observation, {}, EventEnd::Never},
};

struct LevelRow {
    std::string_view name;
    std::uint16_t severity;
};

/// In the order of EventLevel.
constexpr std::array level_rows{
    LevelRow{"Major fault", 1'000}, LevelRow{"Partial fault", 900}, LevelRow{"Minor fault", 700},
    LevelRow{"Observation", 400},   LevelRow{"Information", 100},
};

} // namespace

std::string_view name(EventLevel level)
{
    return level_rows[static_cast<std::size_t>(level)].name;
}

std::uint16_t severity_of(EventLevel level)
{
    return level_rows[static_cast<std::size_t>(level)].severity;
}

std::span<const MachineEventType> machine_event_types()
{
    return event_types;
}

const MachineEventType* machine_event_type(std::uint32_t code)
{
    const auto found = std::find_if(event_types.begin(), event_types.end(),
                                    [&](const auto& each) { return each.code == code; });
    return found == event_types.end() ? nullptr : &*found;
}

std::string code_text(const MachineEventType& type)
{
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string text;
    for (int shift = 28; shift >= 0; shift -= 4) {
        text += digits[(type.code >> static_cast<unsigned>(shift)) & 15U];
    }
    return text;
}

std::string text(const MachineEvent& event)
{
    std::string result = code_text(*event.type) + " " + std::string{event.type->name};
    for (std::size_t i = 0; i < event.attached.size(); ++i) {
        result += (i == 0 ? ": " : ", ") + event.attached[i];
    }
    return result;
}

} // namespace busbar::controller

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>

namespace busbar::controller {

/// How far an event reaches (seed 000, 9-1-2); the highest first.
enum class EventLevel : std::uint8_t {
    MajorFault,   // everything stops
    PartialFault, // all of one function module stops
    MinorFault,   // some of it stops
    Observation,
    Information, // no error
};

/// "Minor fault".
[[nodiscard]] BUSBAR_API std::string_view name(EventLevel level);
/// Of an OPC UA event (Part 5, 6.4.2): 1,000, 900, 700, 400 and 100.
[[nodiscard]] BUSBAR_API std::uint16_t severity_of(EventLevel level);

/// Until when an event stands, that is, is one of the current errors.
enum class EventEnd : std::uint8_t {
    Never,       // it does not stand: something happened
    Automatic,   // its cause is gone
    Renewal,     // there is another certificate
    Preparation, // the address space is prepared anew
    Restart,
};

/// What can stand in the event log: the tables of seed 000, 9-2-1 and 9-2-2.
struct MachineEventType {
    std::uint32_t code; // 0x35D30000
    std::string_view name;
    EventLevel level;
    /// The one that a user may choose instead.
    std::optional<EventLevel> other_level;
    EventEnd end;
};

/// The 16 events of the server, the three of its instructions, and one with code 0, which is ours:
/// the manual asks for it and has no code (seed 000, 5-1-1).
[[nodiscard]] BUSBAR_API std::span<const MachineEventType> machine_event_types();
/// Null if there is none.
[[nodiscard]] BUSBAR_API const MachineEventType* machine_event_type(std::uint32_t code);

// Of all of them.
inline constexpr std::string_view machine_event_source = "PLC Function Module";
inline constexpr std::string_view machine_event_source_details = "OPC UA Server";
inline constexpr std::string_view machine_event_category = "System";

/// One that happened.
struct MachineEvent {
    std::uint64_t number{0};               // each has one more than the one before
    DateTime time;                         // of its detection
    const MachineEventType* type{nullptr}; // of machine_event_types()
    EventLevel level{EventLevel::Information};
    /// Attached information 1, 2 and so on, at most four; without control characters.
    std::vector<std::string> attached;
};

/// "35D40000 Unsupported Data Type: 21": code, name and what is attached.
[[nodiscard]] BUSBAR_API std::string text(const MachineEvent& event);
/// "35D30000".
[[nodiscard]] BUSBAR_API std::string code_text(const MachineEventType& type);

} // namespace busbar::controller

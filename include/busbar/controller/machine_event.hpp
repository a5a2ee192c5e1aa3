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
    // One sentence each; without a correction where there is nothing to correct.
    std::string_view meaning;
    std::string_view cause;
    std::string_view correction;
};

/// The 16 events of the server, the three of its instructions, and five of ours, for which the
/// manuals of the server have no code: 0 is a client certificate that has expired (seed 000,
/// 5-1-1), 1 to 3 are faults of the controller (9-1-2), 4 is a configuration that cannot be used.
[[nodiscard]] BUSBAR_API std::span<const MachineEventType> machine_event_types();
/// Null if there is none.
[[nodiscard]] BUSBAR_API const MachineEventType* machine_event_type(std::uint32_t code);

// Of all of them.
inline constexpr std::string_view machine_event_source = "PLC Function Module";
inline constexpr std::string_view machine_event_source_details = "OPC UA Server";
inline constexpr std::string_view machine_event_category = "System";

/// "OPC UA Server"; "CPU Unit" for faults of the controller.
[[nodiscard]] BUSBAR_API std::string_view source_details(const MachineEventType& type);

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
/// The same, and how to correct it if there is something to correct.
[[nodiscard]] BUSBAR_API std::string what_to_do(const MachineEvent& event);
/// "35D30000".
[[nodiscard]] BUSBAR_API std::string code_text(const MachineEventType& type);

/// The events of a file of the event log, such as clients see it, the oldest first. Lines that are
/// damaged, or have a code that is not known, are passed over.
[[nodiscard]] BUSBAR_API std::vector<MachineEvent> read_machine_events(std::string_view text);

} // namespace busbar::controller

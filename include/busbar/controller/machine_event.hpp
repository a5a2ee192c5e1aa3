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

/// The scope of an event (W588, 9-1-2); the highest first.
enum class EventLevel : std::uint8_t {
    MajorFault,   // everything stops
    PartialFault, // one function module stops completely
    MinorFault,   // a part of a function module stops
    Observation,
    Information, // not an error
};

/// "Minor fault".
[[nodiscard]] BUSBAR_API std::string_view name(EventLevel level);
/// Returns the severity of an OPC UA event (Part 5, 6.4.2): 1,000, 900, 700, 400 or 100.
[[nodiscard]] BUSBAR_API std::uint16_t severity_of(EventLevel level);

/// The time at which an event ceases to be one of the current errors.
enum class EventEnd : std::uint8_t {
    Never,       // it never is one: something happened
    Automatic,   // when its cause is removed
    Renewal,     // when there is another certificate
    Preparation, // when the address space is prepared again
    Restart,
};

/// A type of event in the event log: the tables of W588, 9-2-1 and 9-2-2.
struct MachineEventType {
    std::uint32_t code; // 0x35D30000
    std::string_view name;
    EventLevel level;
    /// The level that a user may select instead.
    std::optional<EventLevel> other_level;
    EventEnd end;
    // One sentence each; the correction is empty if there is nothing to correct.
    std::string_view meaning;
    std::string_view cause;
    std::string_view correction;
};

/// Returns the 16 events of the server, the three of its instructions, and six of our own, for
/// which the server's manuals have no code: 0 is a client certificate that has expired (manual of
/// variables mode, 5-1-1), 1 to 3 are faults of the controller (9-1-2), 4 is an unusable
/// configuration, 5 is a worn storage medium (7-4-5).
[[nodiscard]] BUSBAR_API std::span<const MachineEventType> machine_event_types();
/// Returns null for an unknown code.
[[nodiscard]] BUSBAR_API const MachineEventType* machine_event_type(std::uint32_t code);

/// The source and the category of all of them.
inline constexpr std::string_view machine_event_source = "PLC Function Module";
inline constexpr std::string_view machine_event_source_details = "OPC UA Server";
inline constexpr std::string_view machine_event_category = "System";

/// Returns "OPC UA Server", or "CPU Unit" for faults of the controller.
[[nodiscard]] BUSBAR_API std::string_view source_details(const MachineEventType& type);

/// An event that happened.
struct MachineEvent {
    std::uint64_t number{0};               // one more than that of the event before
    DateTime time;                         // the time of its detection
    const MachineEventType* type{nullptr}; // one of machine_event_types()
    EventLevel level{EventLevel::Information};
    /// Attached information 1, 2 and so on, at most four; without control characters.
    std::vector<std::string> attached;
};

/// Returns code, name and attached information: "35D40000 Unsupported Data Type: 21".
[[nodiscard]] BUSBAR_API std::string text(const MachineEvent& event);
/// Returns the same with the correction, if there is one.
[[nodiscard]] BUSBAR_API std::string what_to_do(const MachineEvent& event);
/// Returns the code as text: "35D30000".
[[nodiscard]] BUSBAR_API std::string code_text(const MachineEventType& type);

/// Returns the events of a file of the event log as clients see it, the oldest first. Lines that
/// are damaged, or have an unknown code, are skipped.
[[nodiscard]] BUSBAR_API std::vector<MachineEvent> read_machine_events(std::string_view text);

} // namespace busbar::controller

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/node_id.hpp>

namespace busbar {
struct EventFilter; // busbar/types/filter.hpp
}

namespace busbar::client {

/// The Events that a client asks for, and the fields that it gets of each.
struct EventSelection {
    /// Browse paths from BaseEventType, with the namespace of each name unless that is 0:
    /// "Message", "2:Press/2:Force". A field that the Event does not have is null.
    std::vector<std::string> fields{"EventType", "SourceName", "Time", "Message", "Severity"};
    /// Only Events of this type and its subtypes; null for all.
    NodeId type{};
    /// Only Events of this severity or above, 1 to 1,000; 0 for all.
    std::uint16_t severity{0};
};

/// Returns the filter of a MonitoredItem that asks for these Events (Part 4, 7.22.3). The fields of
/// a notification come in the order of the selection.
[[nodiscard]] BUSBAR_API EventFilter event_filter(const EventSelection& selection);

} // namespace busbar::client

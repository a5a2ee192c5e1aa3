#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/client/subscriptions.hpp>

#include "output.hpp"

namespace busbar::tool {

/// The fields that are always requested (Part 5, 6.4.2); the user's own fields follow.
inline constexpr std::array<std::string_view, 6> standard_event_fields{
    "Time", "Severity", "SourceName", "Message", "EventType", "EventId"};

/// The events to show, and their fields.
struct EventChoice {
    /// The user's own fields, after the standard ones: "2:Press/Force".
    std::vector<std::string> fields{};
    /// Only from this one on.
    std::uint16_t severity{0};
    /// Only of this type and its subtypes; null for all.
    NodeId type{};
};
/// Asks `node` for its events.
[[nodiscard]] client::ItemSettings event_item(client::NodeAddress node,
                                              const EventChoice& choice = {});
/// A field on one line, without quotes if it is a text; "-" for none.
[[nodiscard]] std::string plain_text(const Variant& field);
/// Severities are in thirds: low, medium, high.
[[nodiscard]] Style event_style(std::uint16_t severity);

} // namespace busbar::tool

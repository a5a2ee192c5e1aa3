#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/client/subscriptions.hpp>

#include "stream.hpp"
#include "tool/printing/output.hpp"

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

/// Events of one node, as a command shows them.
struct EventStream {
    std::string node;
    EventChoice choice{};
    StreamEnd end{};
    /// Above the lines for people.
    std::string title{};
};

/// The standard fields, followed by those of the choice.
using EventFields = Array<Variant>;

/// Shows events as they come until the end of the stream, each by `show` or, for scripts, as one
/// JSON document on a line; throws Failure, and Interrupted after Ctrl+C. `show` may ask the server
/// for more, and may throw.
void follow_events(Context& context, Connection& connection, const EventStream& events,
                   const std::function<void(const EventFields&)>& show);

/// Fits `text` into exactly this number of columns.
[[nodiscard]] std::string padded(std::string_view text, std::size_t columns);
/// Width for the last part of a line of which so much is `used`; never less than a word.
[[nodiscard]] std::size_t columns_left(std::size_t columns, std::size_t used);

} // namespace busbar::tool

#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "stream.hpp"
#include "tool/printing/event_fields.hpp"

namespace busbar::tool {

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

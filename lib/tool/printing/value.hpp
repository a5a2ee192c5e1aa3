#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/core/types.hpp>

#include "json_writer.hpp"
#include "output.hpp"

namespace busbar::tool {

/// The types of structures that are known; may be null.
using Types = std::shared_ptr<const binary::DynamicTypes>;

/// A value for people, on one line.
[[nodiscard]] std::string text_of(const Variant& value, const Types& types);
/// The value, or the name of a bad status.
[[nodiscard]] std::string text_of(const DataValue& value, const Types& types);
/// The same, and after a value the name of a status that is neither bad nor just Good: "17
/// Good_Overload".
[[nodiscard]] std::string full_text_of(const DataValue& value, const Types& types);
/// "Bad_NodeIdUnknown", or the number if it has no name.
[[nodiscard]] std::string text_of(StatusCode status);
[[nodiscard]] Style style_of(StatusCode status);
/// "12:34:56.789" in UTC; "-" for no time.
[[nodiscard]] std::string time_of_day(DateTime time);

/// Adds the members value, type, status, sourceTimestamp and serverTimestamp.
void append_json(JsonLine& json, const DataValue& value, const Types& types);
/// The value alone.
void append_json(JsonLine& json, const Variant& value, const Types& types);

} // namespace busbar::tool

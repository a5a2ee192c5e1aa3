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

/// Hints for the text of a value.
struct ValueHints {
    /// Names an enumeration's values and the times of a PLC; null if it is not known.
    NodeId data_type{};
    /// Digits that a Double is rounded to; 0: all.
    int max_digits{0};
};

/// A value for people, on one line.
[[nodiscard]] std::string text_of(const Variant& value, const Types& types,
                                  const ValueHints& hints = {});
/// The value, or the name of a bad status.
[[nodiscard]] std::string text_of(const DataValue& value, const Types& types,
                                  const ValueHints& hints = {});
/// The same, and after a value the name of a status that is neither bad nor just Good: "17
/// Good_Overload".
[[nodiscard]] std::string full_text_of(const DataValue& value, const Types& types,
                                       const ValueHints& hints = {});
/// The value for scripts, as `busbar write` takes it back: a text without quotes, an enumeration's
/// name, structures and arrays in JSON. One line, without control characters; of a bad value the
/// name of the status.
[[nodiscard]] std::string raw_text_of(const DataValue& value, const Types& types,
                                      const NodeId& data_type);
/// The type that `data_type` names; null if it is not known.
[[nodiscard]] const binary::DynamicType* find_type(const Types& types, const NodeId& data_type);
/// "Bad_NodeIdUnknown", or the number if it has no name.
[[nodiscard]] std::string text_of(StatusCode status);
[[nodiscard]] Style style_of(StatusCode status);
/// "12:34:56.789" in UTC; "-" for no time.
[[nodiscard]] std::string time_of_day(DateTime time);

/// Adds the members value, type, status, sourceTimestamp and serverTimestamp, and for a number that
/// the DataType names, valueName.
void append_json(JsonLine& json, const DataValue& value, const Types& types,
                 const NodeId& data_type = {});
/// The value alone.
void append_json(JsonLine& json, const Variant& value, const Types& types);

} // namespace busbar::tool

#pragma once

#include <cstddef>
#include <string>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/core/api.hpp>

/// Values as JSON for scripts, in the compact form of Part 6, 5.4: Int64 and UInt64 as strings, NaN
/// and Infinity as strings, ByteStrings in base64, NodeIds as text. The result is always valid JSON
/// in UTF-8; control characters are escaped, bytes that are not UTF-8 become U+FFFD.
namespace busbar::client {

struct JsonOptions {
    /// Structures whose encoding is among these are objects with their fields; others are base64.
    const binary::DynamicTypes* types{nullptr};
    /// A Variant as {"UaType": 6, "Value": 5, "Dimensions": [...]}; false: its value alone, a
    /// matrix as lists of lists.
    bool with_types{true};
    /// Levels of values within one another; deeper ones are null.
    std::size_t max_depth{100};
};

[[nodiscard]] BUSBAR_API std::string to_json(const Variant& value, const JsonOptions& options = {});
/// With Status, SourceTimestamp and ServerTimestamp where they are not Good or zero.
[[nodiscard]] BUSBAR_API std::string to_json(const DataValue& value,
                                             const JsonOptions& options = {});
[[nodiscard]] BUSBAR_API std::string to_json(const binary::DynamicValue& value,
                                             const JsonOptions& options = {});

} // namespace busbar::client

#pragma once

#include <cstddef>
#include <string>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/core/api.hpp>

/// Writes values as JSON for scripts, in the compact form of Part 6, 5.4: Int64 and UInt64 as
/// strings, NaN and Infinity as strings, ByteStrings in base64, NodeIds as text. The result is
/// always valid JSON in UTF-8; control characters are escaped, bytes that are not UTF-8 become
/// U+FFFD.
namespace busbar::client {

/// The form of values in JSON.
struct JsonOptions {
    /// Structures with one of these encodings are objects with their fields; others are base64.
    const binary::DynamicTypes* types{nullptr};
    /// Writes a Variant as {"UaType": 6, "Value": 5, "Dimensions": [...]}; if false, its value
    /// alone, a matrix as lists of lists.
    bool with_types{true};
    /// Nesting levels of values; deeper ones are null.
    std::size_t max_depth{100};
};

/// Writes a value as JSON.
[[nodiscard]] BUSBAR_API std::string to_json(const Variant& value, const JsonOptions& options = {});
/// Adds Status, SourceTimestamp and ServerTimestamp unless they are Good or zero.
[[nodiscard]] BUSBAR_API std::string to_json(const DataValue& value,
                                             const JsonOptions& options = {});
/// Writes a value as JSON.
[[nodiscard]] BUSBAR_API std::string to_json(const binary::DynamicValue& value,
                                             const JsonOptions& options = {});

} // namespace busbar::client

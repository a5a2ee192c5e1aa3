#pragma once

#include <optional>
#include <string>
#include <vector>

#include <busbar/client/type_dictionary.hpp>

namespace busbar::client::detail {

inline constexpr std::string_view binary_schema_uri = "http://opcfoundation.org/BinarySchema/";
inline constexpr std::string_view ua_uri = "http://opcfoundation.org/UA/";

/// A Field of a StructuredType as in the dictionary (Part 5, C.2.6).
struct RawField {
    std::string name;
    DictionaryName type;
    std::optional<std::uint32_t> length;
    std::string length_field;
    std::string switch_field;
    std::optional<std::uint32_t> switch_value;
    bool is_length_in_bytes{false};
    /// SwitchOperand differs from Equals.
    bool has_operand{false};
    bool has_terminator{false};
};

/// Recognises the constructs of OPC UA Binary in a sequence of fields, and sets the kind, fields
/// and reason of `type`. `says_union`: the BaseType is Union.
void lay_out(const std::vector<RawField>& fields, bool says_union, DictionaryType& type);

} // namespace busbar::client::detail

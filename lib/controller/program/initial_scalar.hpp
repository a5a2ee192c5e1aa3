#pragma once

#include <string>

#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// Tells whether a value without parts suits the elementary type: its kind, range, subrange and
/// length.
[[nodiscard]] bool is_of_type(const InitialValue& value, const ResolvedType& type);

/// Describes a value: "70000", "a text of 6 bytes", "T#5ms".
[[nodiscard]] std::string value_words(const InitialValue& value);
/// Describes a type: "a value of INT (0..100)".
[[nodiscard]] std::string type_words(const ResolvedType& type);

} // namespace busbar::controller::detail

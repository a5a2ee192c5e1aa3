#pragma once

#include <string>

#include <busbar/core/api.hpp>
#include <busbar/core/types.hpp>

/// Prints values for failing tests: one line each, long arrays shortened.
namespace busbar::harness {

/// Returns "Bad_Timeout"; "0x80AB0401" if the code has no name or has info bits.
[[nodiscard]] BUSBAR_API std::string text_of(StatusCode code);
/// "Int32 42", "String \"abc\"", "Double[3] {1, 2, 3}", "null".
[[nodiscard]] BUSBAR_API std::string text_of(const Variant& value);
/// Value, status unless it is Good, and the timestamps that are set.
[[nodiscard]] BUSBAR_API std::string text_of(const DataValue& value);

} // namespace busbar::harness

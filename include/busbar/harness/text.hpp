#pragma once

#include <string>

#include <busbar/core/api.hpp>
#include <busbar/core/types.hpp>

/// Values as a failing test shows them: one line each, long arrays cut short.
namespace busbar::harness {

/// "Bad_Timeout"; "0x80AB0401" where the code has no name or info bits.
[[nodiscard]] BUSBAR_API std::string text_of(StatusCode code);
/// "Int32 42", "String \"abc\"", "Double[3] {1, 2, 3}", "null".
[[nodiscard]] BUSBAR_API std::string text_of(const Variant& value);
/// Value, status unless it is Good, and the timestamps that are set.
[[nodiscard]] BUSBAR_API std::string text_of(const DataValue& value);

} // namespace busbar::harness

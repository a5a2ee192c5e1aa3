#pragma once

#include <busbar/core/api.hpp>
#include <busbar/core/variant.hpp>

namespace busbar {

/// True if `value` differs from `last` by more than an absolute deadband (Part 4, 7.22.2). Of
/// arrays one element that does is enough; other types and values of different types or sizes
/// differ by any difference. NaN differs from every number and not from NaN.
[[nodiscard]] BUSBAR_API bool is_past_deadband(const Variant& last, const Variant& value,
                                               double deadband);

} // namespace busbar

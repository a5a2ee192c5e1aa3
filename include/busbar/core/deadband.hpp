#pragma once

#include <busbar/core/api.hpp>
#include <busbar/core/variant.hpp>

namespace busbar {

/// True if `value` differs from `last` by more than an absolute deadband in the unit of the value
/// (Part 4, 7.22.2). An array exceeds it if one element does. Values that are not numbers, or that
/// differ in type or size, exceed it if they differ at all. NaN exceeds it from every number and
/// not from NaN.
[[nodiscard]] BUSBAR_API bool is_past_deadband(const Variant& last, const Variant& value,
                                               double deadband);

} // namespace busbar

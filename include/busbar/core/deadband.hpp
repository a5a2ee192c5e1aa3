#pragma once

#include <busbar/core/api.hpp>
#include <busbar/core/variant.hpp>

namespace busbar {

/// True if `value` is further from `last` than an absolute deadband, in the unit of the value (Part
/// 4, 7.22.2). Of an array one such element is enough. Values that are no numbers, or that differ
/// in type or size, are past it if they differ at all. NaN is past it from every number and not
/// from NaN.
[[nodiscard]] BUSBAR_API bool is_past_deadband(const Variant& last, const Variant& value,
                                               double deadband);

} // namespace busbar

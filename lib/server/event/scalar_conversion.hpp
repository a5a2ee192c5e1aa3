#pragma once

#include <busbar/core/types.hpp>

namespace busbar::server::detail {

/// The scalar as one of the type, whether the rules allow that or not; null if it is none, be it
/// that the number is too large or that the text is not that of such a value (Part 4, 7.7.3).
[[nodiscard]] Variant convert_scalar(const Variant& value, BuiltInType to);

} // namespace busbar::server::detail

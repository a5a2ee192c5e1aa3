#pragma once

#include <busbar/core/types.hpp>

namespace busbar::server::detail {

/// Returns the scalar converted to the type, whether the rules allow that or not; null if that is
/// impossible, because the number is too large or the text is not such a value (Part 4, 7.7.3).
[[nodiscard]] Variant convert_scalar(const Variant& value, BuiltInType to);

} // namespace busbar::server::detail

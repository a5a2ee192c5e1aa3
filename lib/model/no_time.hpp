#pragma once

#include <busbar/core/date_time.hpp>

namespace busbar::model::detail {

/// The source timestamp of a value that was set without one: null for everybody, and different from
/// that of a value that came with its node and was never set.
inline constexpr DateTime no_time{-1};

} // namespace busbar::model::detail

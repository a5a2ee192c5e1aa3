#pragma once

#include <busbar/binary/reader.hpp>

namespace busbar::client {

/// What a response may contain: what was asked for may be answered by elements of a few bytes each,
/// say 65,536 Booleans without timestamps.
inline constexpr binary::DecodeLimits response_limits{.free_memory = 4U << 20U};

} // namespace busbar::client

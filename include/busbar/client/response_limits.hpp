#pragma once

#include <busbar/binary/reader.hpp>

namespace busbar::client {

/// Limits of a response, which may consist of elements of a few bytes each, such as 65,536 Booleans
/// without timestamps.
inline constexpr binary::DecodeLimits response_limits{.free_memory = 4U << 20U};

} // namespace busbar::client

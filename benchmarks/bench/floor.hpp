#pragma once

#include <cstddef>

#include <busbar/channel/channel_types.hpp>

namespace busbar::bench {

/// Microseconds for what no stack can do without: `request` bytes to another thread over loopback
/// TCP and `response` bytes back, and with security their AES and HMAC on both sides.
[[nodiscard]] double floor_us(std::size_t request, std::size_t response,
                              const channel::SecuritySetting& security);

} // namespace busbar::bench

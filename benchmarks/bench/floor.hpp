#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/date_time.hpp>

namespace busbar::bench {

/// What no stack can do without, in microseconds; 0 where it is not known.
struct Floor {
    /// Time that passes while both sides do their part, one after the other.
    double both_us{0};
    /// Processor time of the server's part, the kernel's included.
    double server_us{0};
};

/// `request` bytes to another thread over loopback TCP and `response` bytes back, and with security
/// their AES and HMAC on both sides.
[[nodiscard]] Floor exchange_floor(std::size_t request, std::size_t response,
                                   const channel::SecuritySetting& security);

/// The RSA of one OpenSecureChannel, CreateSession and ActivateSession (Part 6, 6.7.4; Part 4,
/// 5.7.2 and 5.7.3), with keys of so many bits on both sides. Nothing without security, or if there
/// are no such keys.
[[nodiscard]] Floor connect_floor(const channel::SecuritySetting& security, std::uint32_t key_bits,
                                  DateTime now);

} // namespace busbar::bench

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// CRC-32 as Ethernet and ZIP have it (ISO 3309): finds damage, not intent.
[[nodiscard]] BUSBAR_API std::uint32_t checksum(std::span<const std::byte> bytes);
/// Eight hexadecimal digits.
[[nodiscard]] BUSBAR_API std::string checksum_text(std::string_view text);

} // namespace busbar::controller::detail

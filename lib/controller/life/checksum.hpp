#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace busbar::controller::detail {

/// CRC-32 as Ethernet and ZIP have it (ISO 3309): finds damage, not intent.
[[nodiscard]] std::uint32_t checksum(std::span<const std::byte> bytes);
/// Eight hexadecimal digits.
[[nodiscard]] std::string checksum_text(std::string_view text);

} // namespace busbar::controller::detail

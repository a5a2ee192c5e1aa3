#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <busbar/core/api.hpp>

namespace busbar::crypto {

/// Computes SHA-256 (FIPS 180-4).
[[nodiscard]] BUSBAR_API std::array<std::byte, 32> sha256(std::span<const std::byte> bytes);

} // namespace busbar::crypto

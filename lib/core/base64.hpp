#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// Base64 with padding (RFC 4648, 4).
[[nodiscard]] BUSBAR_API std::string to_base64(std::span<const std::byte> bytes);

/// Returns the bytes, or nothing if a character or the padding is wrong.
[[nodiscard]] BUSBAR_API std::optional<std::vector<std::byte>> from_base64(std::string_view text);

} // namespace busbar::detail

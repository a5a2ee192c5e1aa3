#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace busbar::controller::detail {

// Texts of labels and UTF-8. Writing gives false for what is not UTF-8 (with surrogates and what is
// longer than need be), and else fills `label`: as many whole characters as fit, the rest zeros. A
// zero in `text` ends it, because it would end the label's. Reading ends at the first zero; what is
// no character becomes U+FFFD.

[[nodiscard]] bool to_shift_jis(std::string_view text, std::span<std::byte> label);
[[nodiscard]] std::string from_shift_jis(std::span<const std::byte> label);

/// Units of 16 bits, little endian; an odd byte at the end is no part of it.
[[nodiscard]] bool to_utf16(std::string_view text, std::span<std::byte> label);
[[nodiscard]] std::string from_utf16(std::span<const std::byte> label);

} // namespace busbar::controller::detail

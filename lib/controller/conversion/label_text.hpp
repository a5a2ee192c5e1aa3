#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace busbar::controller::detail {

// Convert between texts of labels and UTF-8. Writing fails for text that is not UTF-8 (surrogates
// and overlong forms included); otherwise it fills `label` with as many whole characters as fit and
// zeros after them. A zero in `text` ends it, because it would end the label's text. Reading ends
// at the first zero; invalid characters become U+FFFD.

[[nodiscard]] bool to_shift_jis(std::string_view text, std::span<std::byte> label);
[[nodiscard]] std::string from_shift_jis(std::span<const std::byte> label);

/// The same for units of 16 bits, little endian; an odd byte at the end is ignored.
[[nodiscard]] bool to_utf16(std::string_view text, std::span<std::byte> label);
[[nodiscard]] std::string from_utf16(std::span<const std::byte> label);

} // namespace busbar::controller::detail

#pragma once

#include <cstddef>
#include <cstdint>
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

/// Appends a character, which must be a code point but not a surrogate.
void append_utf8(char32_t character, std::string& text);

/// The katakana middle dot replaces code points that Shift-JIS does not have (SH-082679, 8.2).
inline constexpr std::uint16_t shift_jis_middle_dot = 0x8145;
inline constexpr char32_t replacement_character = 0xFFFD;

/// Returns the code of a character: one byte (up to 0xFF) or two, the first in the upper half. A
/// character without a code becomes the middle dot.
///
/// If a character has several codes, the result is the one that Windows uses: row 13 and JIS X 0208
/// take precedence over IBM's rows, and these over NEC's selection. Six characters that other
/// tables have in place of Windows' own, such as U+301C for the wave dash, are mapped to those.
[[nodiscard]] std::uint16_t shift_jis_of(char32_t character);

struct ShiftJisCharacter {
    char32_t character{0};
    /// Number of bytes taken.
    std::size_t size{0};
};

/// Decodes the character at the front of `text`, which must not be empty. Invalid bytes become
/// U+FFFD: the first byte alone, unless the second can only be a trail byte.
[[nodiscard]] ShiftJisCharacter shift_jis_at(std::span<const std::byte> text);

} // namespace busbar::controller::detail

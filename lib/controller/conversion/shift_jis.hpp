#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace busbar::controller::detail {

/// What code points that Shift-JIS has not become: the katakana middle dot (SH-082679, 8.2).
inline constexpr std::uint16_t shift_jis_middle_dot = 0x8145;
inline constexpr char32_t replacement_character = 0xFFFD;

/// The code of a character: one byte (up to 0xFF) or two, the first one in the upper half. The
/// middle dot for what has none.
///
/// Of characters with several codes it is the one that Windows takes: row 13 and JIS X 0208 before
/// IBM's, and these before NEC's selection. Six characters that other tables have in place of
/// Windows' own, such as U+301C for the wave dash, are taken for those.
[[nodiscard]] std::uint16_t shift_jis_of(char32_t character);

struct ShiftJisCharacter {
    char32_t character{0};
    /// Bytes it took.
    std::size_t size{0};
};

/// The character at the front of `text`, which is not empty. U+FFFD for bytes that are none: the
/// first byte only, unless the second could only be a second one.
[[nodiscard]] ShiftJisCharacter shift_jis_at(std::span<const std::byte> text);

} // namespace busbar::controller::detail

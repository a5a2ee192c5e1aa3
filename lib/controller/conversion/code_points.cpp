#include "controller/conversion/code_points.hpp"

#include <array>
#include <cstddef>

namespace busbar::controller::detail {

namespace {

/// One form of UTF-8 by its number of bytes: the least code point that needs it, the bits of the
/// first byte that tell the length, and the bits that belong to the code point.
struct Form {
    char32_t least;
    unsigned mark;
    unsigned mask;
};
constexpr std::array forms{
    Form{0, 0, 0x7F},
    Form{0x80, 0xC0, 0x1F},
    Form{0x800, 0xE0, 0x0F},
    Form{0x1'0000, 0xF0, 0x07},
};
constexpr char32_t last_code_point = 0x10'FFFF;

unsigned byte_at(std::string_view text, std::size_t i)
{
    return static_cast<unsigned char>(text[i]);
}

/// Tells the number of bytes from the first byte; 0 if no code point begins with it.
std::size_t size_by(unsigned first)
{
    for (std::size_t size = forms.size(); size > 0; --size) {
        const Form& form = forms[size - 1];
        if ((first & ~form.mask & 0xFFU) == form.mark) {
            return size;
        }
    }
    return 0;
}

} // namespace

std::optional<char32_t> take_utf8(std::string_view& text)
{
    const std::size_t size = size_by(byte_at(text, 0));
    if (size == 0 || size > text.size()) {
        return std::nullopt;
    }
    char32_t character = byte_at(text, 0) & forms[size - 1].mask;
    for (std::size_t i = 1; i < size; ++i) {
        if ((byte_at(text, i) & 0xC0U) != 0x80U) {
            return std::nullopt;
        }
        character = character << 6U | (byte_at(text, i) & 0x3FU);
    }
    if (character < forms[size - 1].least || character > last_code_point ||
        is_surrogate(character)) {
        return std::nullopt;
    }
    text.remove_prefix(size);
    return character;
}

void append_utf8(char32_t character, std::string& text)
{
    std::size_t size = forms.size();
    while (character < forms[size - 1].least) {
        --size;
    }
    unsigned shift = static_cast<unsigned>(size - 1) * 6;
    text += static_cast<char>(forms[size - 1].mark | character >> shift);
    while (shift > 0) {
        shift -= 6;
        text += static_cast<char>(0x80U | (character >> shift & 0x3FU));
    }
}

} // namespace busbar::controller::detail

#include "controller/conversion/label_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace busbar::controller::detail {

namespace {

constexpr bool is_surrogate(char32_t unit)
{
    return unit >= 0xD800 && unit <= 0xDFFF;
}

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

/// Takes the code point at the front of `text`, which must not be empty. Gives nothing, and leaves
/// `text` alone, if that is not UTF-8 (RFC 3629, 3).
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

/// Puts units of a character at the front of `rest`, all of them or none.
template <typename Encode>
bool write_text(std::string_view text, std::span<std::byte> label, Encode encode)
{
    std::span<std::byte> rest = label;
    bool is_full = false;
    bool is_over = false;
    while (!text.empty()) { // to its end, because all of it must be UTF-8
        const auto character = take_utf8(text);
        if (!character) {
            return false;
        }
        is_over = is_over || *character == 0;
        if (!is_full && !is_over) {
            const std::size_t size = encode(*character, rest);
            is_full = size == 0;
            rest = rest.subspan(size);
        }
    }
    std::fill(rest.begin(), rest.end(), std::byte{0});
    return true;
}

void put_unit(char32_t unit, std::span<std::byte> to)
{
    to[0] = static_cast<std::byte>(unit & 0xFFU);
    to[1] = static_cast<std::byte>(unit >> 8U & 0xFFU);
}

std::size_t put_shift_jis(char32_t character, std::span<std::byte> to)
{
    const std::uint16_t code = shift_jis_of(character);
    const std::size_t size = code > 0xFF ? 2 : 1;
    if (size > to.size()) {
        return 0;
    }
    to[0] = static_cast<std::byte>(size == 2 ? code >> 8U : code);
    if (size == 2) {
        to[1] = static_cast<std::byte>(code & 0xFFU);
    }
    return size;
}

std::size_t put_utf16(char32_t character, std::span<std::byte> to)
{
    const std::size_t size = character > 0xFFFF ? 4 : 2;
    if (size > to.size()) {
        return 0;
    }
    if (size == 2) {
        put_unit(character, to);
        return size;
    }
    const char32_t above = character - 0x10000;
    put_unit(0xD800 + (above >> 10U), to);
    put_unit(0xDC00 + (above & 0x3FFU), to.subspan(2));
    return size;
}

char32_t unit_at(std::span<const std::byte> label, std::size_t at)
{
    return at + 1 < label.size() ? std::to_integer<char32_t>(label[at]) |
                                       std::to_integer<char32_t>(label[at + 1]) << 8U
                                 : 0;
}

} // namespace

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

bool to_shift_jis(std::string_view text, std::span<std::byte> label)
{
    return write_text(text, label, put_shift_jis);
}

std::string from_shift_jis(std::span<const std::byte> label)
{
    std::string text;
    while (!label.empty() && label.front() != std::byte{0}) {
        const ShiftJisCharacter next = shift_jis_at(label);
        append_utf8(next.character, text);
        label = label.subspan(next.size);
    }
    return text;
}

bool to_utf16(std::string_view text, std::span<std::byte> label)
{
    return write_text(text, label, put_utf16);
}

std::string from_utf16(std::span<const std::byte> label)
{
    std::string text;
    std::size_t at = 0;
    while (const char32_t unit = unit_at(label, at)) {
        at += 2;
        const char32_t next = unit_at(label, at);
        if (!is_surrogate(unit)) {
            append_utf8(unit, text);
        } else if (unit < 0xDC00 && next >= 0xDC00 && next <= 0xDFFF) {
            append_utf8(0x10000 + ((unit - 0xD800) << 10U) + (next - 0xDC00), text);
            at += 2;
        } else {
            append_utf8(replacement_character, text);
        }
    }
    return text;
}

} // namespace busbar::controller::detail

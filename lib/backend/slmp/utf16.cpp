#include "backend/slmp/codec.hpp"

#include "core/utf8.hpp"

namespace busbar::backend::detail {

namespace {

constexpr char32_t first_high = 0xD800;
constexpr char32_t first_low = 0xDC00;
constexpr char32_t after_low = 0xE000;
constexpr char32_t first_pair = 0x10000;

/// Takes the first character off the text, which is UTF-8.
char32_t next_character(std::string_view& text)
{
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
    const std::size_t size = byte(0) < 0x80 ? 1 : byte(0) < 0xE0 ? 2 : byte(0) < 0xF0 ? 3 : 4;
    char32_t character = size == 1 ? byte(0) : byte(0) & (0x7FU >> size);
    for (std::size_t at = 1; at < size; ++at) {
        character = (character << 6U) | (byte(at) & 0x3FU);
    }
    text.remove_prefix(size);
    return character;
}

void append_utf8(std::string& text, char32_t character)
{
    const auto put = [&](char32_t bits) { text += static_cast<char>(bits); };
    const auto rest = [&](unsigned shift) { put(0x80U | ((character >> shift) & 0x3FU)); };
    if (character < 0x80) {
        put(character);
    } else if (character < 0x800) {
        put(0xC0U | (character >> 6U));
        rest(0);
    } else if (character < first_pair) {
        put(0xE0U | (character >> 12U));
        rest(6);
        rest(0);
    } else {
        put(0xF0U | (character >> 18U));
        rest(12);
        rest(6);
        rest(0);
    }
}

} // namespace

bool write_utf16(binary::Writer& writer, std::string_view text)
{
    if (!busbar::detail::is_utf8(text)) {
        return false;
    }
    std::u16string units;
    while (!text.empty()) {
        const char32_t character = next_character(text);
        if (character < first_pair) {
            units += static_cast<char16_t>(character);
        } else {
            const char32_t bits = character - first_pair;
            units += static_cast<char16_t>(first_high + (bits >> 10U));
            units += static_cast<char16_t>(first_low + (bits & 0x3FFU));
        }
    }
    if (units.size() > UINT16_MAX) {
        return false;
    }
    writer.number(static_cast<std::uint16_t>(units.size()));
    for (const char16_t unit : units) {
        writer.number(static_cast<std::uint16_t>(unit));
    }
    return true;
}

std::optional<std::string> read_utf16(binary::Reader& reader)
{
    const std::size_t size = reader.number<std::uint16_t>();
    if (size * 2 > reader.remaining()) {
        return std::nullopt;
    }
    std::string text;
    for (std::size_t at = 0; at < size; ++at) {
        char32_t character = reader.number<std::uint16_t>();
        if (character >= first_high && character < after_low) {
            const char32_t low = at + 1 < size ? reader.number<std::uint16_t>() : U'\0';
            if (character >= first_low || low < first_low || low >= after_low) {
                return std::nullopt;
            }
            character = first_pair + ((character - first_high) << 10U) + (low - first_low);
            ++at;
        }
        append_utf8(text, character);
    }
    return text;
}

} // namespace busbar::backend::detail

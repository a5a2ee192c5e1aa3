#include <busbar/controller/text_encoding.hpp>

#include <algorithm>
#include <array>
#include <span>

#include <busbar/core/text.hpp>

#include "controller/conversion/label_text.hpp"
#include "core/ascii_case.hpp"
#include "core/utf8.hpp"
#include "declaration_cursor.hpp"
#include "program_problem.hpp"

namespace busbar::controller {

namespace {

using detail::replacement_character;

struct NameRow {
    std::string_view name;
    TextEncoding encoding;
};

/// The names by which people, XML declarations and Windows know the encodings.
constexpr std::array encoding_names{
    NameRow{"utf-8", TextEncoding::Utf8},
    NameRow{"utf8", TextEncoding::Utf8},
    NameRow{"us-ascii", TextEncoding::Utf8},
    NameRow{"ascii", TextEncoding::Utf8},
    NameRow{"utf-16", TextEncoding::Utf16Little},
    NameRow{"utf16", TextEncoding::Utf16Little},
    NameRow{"utf-16le", TextEncoding::Utf16Little},
    NameRow{"utf-16be", TextEncoding::Utf16Big},
    NameRow{"shift-jis", TextEncoding::ShiftJis},
    NameRow{"shift_jis", TextEncoding::ShiftJis},
    NameRow{"sjis", TextEncoding::ShiftJis},
    NameRow{"x-sjis", TextEncoding::ShiftJis},
    NameRow{"ms932", TextEncoding::ShiftJis},
    NameRow{"cp932", TextEncoding::ShiftJis},
    NameRow{"windows-31j", TextEncoding::ShiftJis},
    NameRow{"windows-1252", TextEncoding::Windows1252},
    NameRow{"cp1252", TextEncoding::Windows1252},
    NameRow{"latin-1", TextEncoding::Windows1252},
    NameRow{"latin1", TextEncoding::Windows1252},
    NameRow{"iso-8859-1", TextEncoding::Windows1252},
};

/// The characters of Windows-1252 from 16#80 to 16#9F; 0 for bytes that it does not have.
constexpr std::array<char16_t, 32> windows_1252{
    0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017D, 0,      0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

unsigned byte_at(std::string_view text, std::size_t i)
{
    return static_cast<unsigned char>(text[i]);
}

/// A character and the number of bytes that it takes; none if the bytes are not of the encoding.
using Character = detail::ShiftJisCharacter;

Character windows_1252_at(std::string_view text)
{
    const unsigned byte = byte_at(text, 0);
    const char32_t character = byte >= 0x80 && byte < 0xA0 ? windows_1252[byte - 0x80] : byte;
    return {character, character != 0 || byte == 0 ? std::size_t{1} : std::size_t{0}};
}

Character shift_jis_at(std::string_view text)
{
    const auto found = detail::shift_jis_at(std::as_bytes(std::span{text}));
    return found.character == replacement_character ? Character{} : found;
}

template <bool is_big>
Character utf16_at(std::string_view text)
{
    const auto unit_at = [&](std::size_t i) {
        const char32_t first = byte_at(text, i);
        const char32_t second = byte_at(text, i + 1);
        return is_big ? first << 8U | second : second << 8U | first;
    };
    if (text.size() < 2) {
        return {};
    }
    const char32_t unit = unit_at(0);
    if (unit < 0xD800 || unit > 0xDFFF) {
        return {unit, 2};
    }
    const char32_t low = unit < 0xDC00 && text.size() >= 4 ? unit_at(2) : 0;
    return low < 0xDC00 || low > 0xDFFF
               ? Character{}
               : Character{0x1'0000 + ((unit - 0xD800) << 10U) + (low - 0xDC00), 4};
}

using CharacterAt = Character (*)(std::string_view text);

CharacterAt reader_of(TextEncoding encoding)
{
    switch (encoding) {
    case TextEncoding::Utf16Little:
        return utf16_at<false>;
    case TextEncoding::Utf16Big:
        return utf16_at<true>;
    case TextEncoding::ShiftJis:
        return shift_jis_at;
    default:
        return windows_1252_at;
    }
}

/// Appends the characters to `to`. Returns false at the first that is not of the encoding.
bool decode(std::string_view bytes, CharacterAt character_at, std::string& to)
{
    to.reserve(bytes.size());
    while (!bytes.empty()) {
        const Character next = character_at(bytes);
        if (next.size == 0) {
            return false;
        }
        detail::append_utf8(next.character, to);
        bytes.remove_prefix(next.size);
    }
    return true;
}

struct Mark {
    std::string_view bytes;
    TextEncoding encoding;
};
constexpr std::array marks{
    Mark{"\xEF\xBB\xBF", TextEncoding::Utf8},
    Mark{"\xFF\xFE", TextEncoding::Utf16Little},
    Mark{"\xFE\xFF", TextEncoding::Utf16Big},
};

TextEncoding utf16_without_mark(std::string_view text)
{
    if (text.size() < 2 || (text[0] == 0) == (text[1] == 0)) {
        return TextEncoding::Recognized;
    }
    return text[1] == 0 ? TextEncoding::Utf16Little : TextEncoding::Utf16Big;
}

/// Returns the encoding of an XML declaration; empty if there is none.
std::string_view xml_encoding(std::string_view text)
{
    constexpr std::string_view key = "encoding";
    const std::size_t end = text.starts_with("<?xml") ? text.find("?>") : text.npos;
    std::string_view declaration = end == text.npos ? std::string_view{} : text.substr(0, end);
    const std::size_t at = declaration.find(key);
    if (at == declaration.npos) {
        return {};
    }
    declaration.remove_prefix(at + key.size());
    const std::size_t first = declaration.find_first_of("'\"");
    const std::size_t last =
        first == declaration.npos ? first : declaration.find(declaration[first], first + 1);
    return last == declaration.npos ? std::string_view{}
                                    : declaration.substr(first + 1, last - first - 1);
}

bool is_mostly_utf8(std::string_view text)
{
    std::size_t good = 0;
    std::size_t bad = 0;
    while (!text.empty()) {
        const std::size_t size = busbar::detail::utf8_sequence(text);
        good += size > 1 ? 1U : 0U;
        bad += byte_at(text, 0) >= 0x80 && size == 0 ? 1U : 0U;
        text.remove_prefix(std::max(size, std::size_t{1}));
    }
    return good > bad;
}

/// Tells whether the text is Shift-JIS and looks like Japanese.
bool is_japanese(std::string_view text)
{
    constexpr std::size_t enough_katakana = 3;
    std::size_t everyday = 0;
    std::size_t rare = 0;
    std::size_t katakana = 0;
    while (!text.empty()) {
        const Character next = shift_jis_at(text);
        if (next.size == 0) {
            return false;
        }
        const unsigned first = byte_at(text, 0);
        katakana = next.size == 1 && first >= 0x80 ? katakana + 1 : 0;
        everyday += (next.size == 2 && first < 0xA0) || katakana == enough_katakana ? 1 : 0;
        rare += next.size == 2 && first >= 0xE0 ? 1 : 0;
        text.remove_prefix(next.size);
    }
    return everyday > rare;
}

/// Finds the encoding of a text that is not UTF-8.
Configured<TextEncoding> recognized(std::string_view text, std::string_view file_name)
{
    if (const std::string_view named = xml_encoding(text); !named.empty()) {
        if (const auto found = find_text_encoding(named)) {
            return *found;
        }
        return misconfigured(detail::place_text(file_name, {1, 1}),
                             "found the encoding '" + printable(named, 40) +
                                 "', expected UTF-8, UTF-16, Shift-JIS or Windows-1252");
    }
    if (is_mostly_utf8(text)) {
        return TextEncoding::Utf8;
    }
    return is_japanese(text) ? TextEncoding::ShiftJis : TextEncoding::Windows1252;
}

Unexpected<Problem> not_of(TextEncoding encoding, std::string_view file_name,
                           std::string_view before)
{
    const bool is_utf16 =
        encoding == TextEncoding::Utf16Little || encoding == TextEncoding::Utf16Big;
    return misconfigured(
        detail::place_text(file_name, detail::TextPlaces{before}.at(before.size())),
        (is_utf16 ? "found a unit" : "found a byte") + std::string{" that is not "} +
            std::string{name(encoding)} + "; expected a text that is, or the name of its encoding");
}

Configured<DecodedText> decode_as(TextEncoding encoding, std::string_view bytes,
                                  std::string_view file_name)
{
    if (encoding == TextEncoding::Utf8) {
        if (const auto offset = detail::first_not_utf8(bytes)) {
            return not_of(encoding, file_name, bytes.substr(0, *offset));
        }
        return DecodedText{bytes, encoding};
    }
    std::string text;
    if (!decode(bytes, reader_of(encoding), text)) {
        return not_of(encoding, file_name, text);
    }
    return DecodedText{std::move(text), encoding};
}

Configured<DecodedText> decode_any(std::string_view bytes, std::string_view file_name,
                                   TextEncoding asked)
{
    for (const Mark& mark : marks) {
        if (bytes.starts_with(mark.bytes)) {
            return decode_as(mark.encoding, bytes.substr(mark.bytes.size()), file_name);
        }
    }
    if (asked == TextEncoding::Recognized) {
        asked = utf16_without_mark(bytes);
    }
    if (asked != TextEncoding::Recognized) {
        return decode_as(asked, bytes, file_name);
    }
    if (!detail::first_not_utf8(bytes)) {
        return DecodedText{bytes, TextEncoding::Utf8};
    }
    return recognized(bytes, file_name).and_then([&](TextEncoding encoding) {
        return decode_as(encoding, bytes, file_name);
    });
}

Unexpected<Problem> too_large(std::string_view file_name, std::size_t max_size)
{
    return misconfigured(detail::place_text(file_name, {}),
                         "is larger than " + std::to_string(max_size) + " bytes");
}

} // namespace

std::string_view name(TextEncoding encoding)
{
    constexpr std::array<std::string_view, 6> names{"UTF-8",    "",          "UTF-16LE",
                                                    "UTF-16BE", "Shift-JIS", "Windows-1252"};
    return names[static_cast<std::size_t>(encoding)];
}

std::optional<TextEncoding> find_text_encoding(std::string_view name)
{
    const auto* const found = std::ranges::find_if(encoding_names, [&](const NameRow& row) {
        return busbar::detail::is_same_ignoring_case(row.name, name);
    });
    return found == encoding_names.end() ? std::nullopt : std::optional{found->encoding};
}

Configured<DecodedText> decode_text(std::string_view bytes, std::string_view file_name,
                                    std::size_t max_size, TextEncoding asked)
{
    if (bytes.size() > max_size) {
        return too_large(file_name, max_size);
    }
    return decode_any(bytes, file_name, asked).and_then([&](DecodedText decoded) {
        return decoded.text().size() > max_size
                   ? Configured<DecodedText>{too_large(file_name, max_size)}
                   : std::move(decoded);
    });
}

} // namespace busbar::controller

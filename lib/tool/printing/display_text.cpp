#include "display_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>

#include <busbar/core/text.hpp>

namespace busbar::tool {

namespace {

struct Range {
    char32_t first;
    char32_t last;
};

// Unicode Standard Annex 11: wide and fullwidth.
constexpr std::array wide{
    Range{0x1100, 0x115F},   Range{0x2E80, 0xA4CF},   Range{0xAC00, 0xD7A3},
    Range{0xF900, 0xFAFF},   Range{0xFE30, 0xFE6F},   Range{0xFF00, 0xFF60},
    Range{0xFFE0, 0xFFE6},   Range{0x1F300, 0x1F64F}, Range{0x1F900, 0x1F9FF},
    Range{0x20000, 0x3FFFD},
};
constexpr std::array combining{
    Range{0x0300, 0x036F}, Range{0x200B, 0x200D}, Range{0x20D0, 0x20FF},
    Range{0xFE00, 0xFE0F}, Range{0xFEFF, 0xFEFF},
};
// Characters that make a terminal write backwards (Unicode Annex 9), and line separators.
constexpr std::array hidden{
    Range{0x061C, 0x061C},
    Range{0x200E, 0x200F},
    Range{0x2028, 0x202E},
    Range{0x2066, 0x2069},
};

template <std::size_t N>
bool is_in(const std::array<Range, N>& ranges, char32_t character)
{
    return std::any_of(ranges.begin(), ranges.end(), [&](const Range& range) {
        return character >= range.first && character <= range.last;
    });
}

/// Takes the next character off valid UTF-8, as `printable` gives it.
std::string_view take_character(std::string_view& text, char32_t& character)
{
    const auto lead = static_cast<unsigned char>(text[0]);
    const std::size_t size = std::min<std::size_t>(lead < 0x80   ? 1
                                                   : lead < 0xE0 ? 2
                                                   : lead < 0xF0 ? 3
                                                                 : 4,
                                                   text.size());
    character = size == 1 ? lead : lead & (0x7FU >> size);
    for (std::size_t i = 1; i < size; ++i) {
        character = (character << 6U) | (static_cast<unsigned char>(text[i]) & 0x3FU);
    }
    const std::string_view taken = text.substr(0, size);
    text.remove_prefix(size);
    return taken;
}

std::size_t width_of(char32_t character)
{
    return is_in(combining, character) ? 0 : is_in(wide, character) ? 2 : 1;
}

} // namespace

std::string safe(std::string_view text)
{
    const std::string bytes = printable(text, 4 * text.size() + 1);
    std::string result;
    std::string_view left{bytes};
    while (!left.empty()) {
        char32_t character = 0;
        const std::string_view taken = take_character(left, character);
        if (is_in(hidden, character)) {
            char escape[8];
            std::snprintf(escape, sizeof escape, "\\u%04X", static_cast<unsigned>(character));
            result += escape;
        } else {
            result += taken;
        }
    }
    return result;
}

std::string safe_line(std::string_view lines)
{
    std::string result;
    while (!lines.empty()) {
        const std::string_view line = lines.substr(0, lines.find('\n'));
        lines.remove_prefix(std::min(lines.size(), line.size() + 1));
        result += (result.empty() ? "" : "; ") + safe(line);
    }
    return result;
}

std::string_view take_character(std::string_view& text)
{
    char32_t character = 0;
    return take_character(text, character);
}

std::size_t display_width(std::string_view text)
{
    std::size_t width = 0;
    while (!text.empty()) {
        char32_t character = 0;
        take_character(text, character);
        width += width_of(character);
    }
    return width;
}

std::string cut(std::string_view text, std::size_t columns)
{
    if (display_width(text) <= columns) {
        return std::string{text};
    }
    const std::string_view mark = std::string_view{"..."}.substr(0, columns);
    std::string result;
    std::size_t width = mark.size();
    while (!text.empty()) {
        char32_t character = 0;
        const std::string_view taken = take_character(text, character);
        width += width_of(character);
        if (width > columns) {
            break;
        }
        result += taken;
    }
    return result.append(mark);
}

std::string cut_front(std::string_view text, std::size_t columns)
{
    std::size_t width = display_width(text);
    if (width <= columns) {
        return std::string{text};
    }
    const std::string_view mark = std::string_view{"..."}.substr(0, columns);
    while (!text.empty() && width + mark.size() > columns) {
        char32_t character = 0;
        take_character(text, character);
        width -= width_of(character);
    }
    return std::string{mark}.append(text);
}

std::string wrap(std::string_view text, std::size_t columns, std::size_t indent)
{
    std::string result;
    std::size_t column = 0;
    while (!text.empty()) {
        const std::size_t blank = std::min(text.find(' '), text.size());
        const std::string_view word = text.substr(0, blank);
        text.remove_prefix(std::min(blank + 1, text.size()));
        const std::size_t width = display_width(word);
        if (column > indent && column + 1 + width > columns) {
            result += "\n" + std::string(indent, ' ');
            column = indent;
        } else if (!result.empty()) {
            result += ' ';
            ++column;
        }
        result += word;
        column += width;
    }
    return result;
}

} // namespace busbar::tool

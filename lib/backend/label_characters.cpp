#include <algorithm>
#include <array>

#include <busbar/backend/label_name.hpp>
#include <busbar/core/text.hpp>

#include "core/utf8.hpp"

namespace busbar::backend {

namespace {

struct Range {
    char32_t first;
    char32_t last;
};

/// The characters that SH-082679, appendix 6, note 1 forbids. Of ASCII's symbols the comma, the
/// period, the brackets and the underscore are allowed. Characters beyond 16 bits would need
/// surrogates.
constexpr std::array forbidden{
    Range{0x00, 0x1F},     Range{0x20, 0x2B},     Range{0x2D, 0x2D},        Range{0x2F, 0x2F},
    Range{0x3A, 0x40},     Range{0x5C, 0x5C},     Range{0x5E, 0x5E},        Range{0x60, 0x60},
    Range{0x7B, 0x7E},     Range{0x80, 0x9F},     Range{0xA0, 0xBF},        Range{0x3000, 0x3000},
    Range{0xD800, 0xDFFF}, Range{0xFFFE, 0xFFFF}, Range{0x10000, 0x10FFFF},
};

bool is_forbidden(char32_t character)
{
    return std::ranges::any_of(forbidden, [&](const Range& range) {
        return character >= range.first && character <= range.last;
    });
}

/// Decodes `sequence`, which must be one UTF-8 character.
char32_t code_point(std::string_view sequence)
{
    constexpr std::array lead_masks{0x00U, 0x7FU, 0x1FU, 0x0FU, 0x07U};
    char32_t result = static_cast<unsigned char>(sequence[0]) & lead_masks[sequence.size()];
    for (const char c : sequence.substr(1)) {
        result = (result << 6U) | (static_cast<unsigned char>(c) & 0x3FU);
    }
    return result;
}

} // namespace

std::optional<Problem> check_label_characters(std::string_view text)
{
    for (std::size_t column = 1; !text.empty(); ++column) {
        const std::size_t size = busbar::detail::utf8_sequence(text);
        if (size == 0 || is_forbidden(code_point(text.substr(0, size)))) {
            const std::string found = printable(text.substr(0, std::max<std::size_t>(size, 1)));
            return Problem{.where = "column " + std::to_string(column),
                           .text = "found '" + found +
                                   "', expected a letter, a digit, '_' or another character that "
                                   "label names can have"};
        }
        text.remove_prefix(size);
    }
    return std::nullopt;
}

} // namespace busbar::backend

#include "label_text.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

#include "controller/conversion/shift_jis_cells.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::size_t row_size = shift_jis_row_size;
constexpr std::size_t cell_count = std::size(shift_jis_cells) - 1; // without the literal's zero

/// Consecutive rows, and the index of the first of them among the cells.
struct Block {
    std::size_t first_row;
    std::size_t rows;
    std::size_t first_cell;
};
constexpr std::array blocks{
    Block{1, 8, 0},
    Block{13, 1, 8 * row_size},
    Block{16, 69, 9 * row_size},
    Block{89, 4, 78 * row_size},
    Block{115, 5, 82 * row_size},
};
static_assert(cell_count == 87 * row_size);

constexpr std::size_t selected_begin = blocks[3].first_cell;
constexpr std::size_t selected_end = blocks[4].first_cell;

/// Computes the code of a cell. Two rows share a lead byte: the first has the trail bytes from 0x40
/// without 0x7F.
constexpr std::uint16_t code_of(std::size_t cell)
{
    std::size_t row = 0;
    for (const Block& block : blocks) {
        if (cell >= block.first_cell) {
            row = block.first_row + (cell - block.first_cell) / row_size - 1;
        }
    }
    const std::size_t pair = row / 2;
    const std::size_t lead = pair < 31 ? 0x81 + pair : 0xC1 + pair;
    const std::size_t place = row % 2 * row_size + cell % row_size;
    const std::size_t trail = 0x40 + place + (place >= 0x3F ? 1 : 0);
    return static_cast<std::uint16_t>(lead << 8U | trail);
}

std::optional<std::size_t> cell_of(unsigned lead, unsigned trail)
{
    const std::size_t place = trail - 0x40 - (trail > 0x7F ? 1 : 0);
    const std::size_t row = (lead - (lead < 0xA0 ? 0x81 : 0xC1)) * 2 + place / row_size + 1;
    for (const Block& block : blocks) {
        if (row >= block.first_row && row < block.first_row + block.rows) {
            return block.first_cell + (row - block.first_row) * row_size + place % row_size;
        }
    }
    return std::nullopt;
}

using CellOf = std::array<std::uint16_t, 0x10000>;

/// Enters cells by their characters; the first cell of a character wins.
constexpr void place_cells(std::size_t from, std::size_t to, CellOf& cells)
{
    for (std::size_t cell = from; cell < to; ++cell) {
        std::uint16_t& entry = cells[shift_jis_cells[cell]];
        if (entry == 0 && shift_jis_cells[cell] != u' ') {
            entry = static_cast<std::uint16_t>(cell + 1);
        }
    }
}

constexpr CellOf place_all()
{
    CellOf cells{};
    place_cells(0, selected_begin, cells);
    place_cells(selected_end, cell_count, cells);
    place_cells(selected_begin, selected_end, cells);
    return cells;
}

constexpr std::size_t character_count()
{
    const CellOf cells = place_all();
    std::size_t count = 0;
    for (const std::uint16_t cell : cells) {
        count += cell != 0 ? 1 : 0;
    }
    return count;
}

/// Cells in the order of their characters.
constexpr auto by_character = [] {
    const CellOf cells = place_all();
    std::array<std::uint16_t, character_count()> result{};
    std::size_t count = 0;
    for (const std::uint16_t cell : cells) {
        if (cell != 0) {
            result[count++] = static_cast<std::uint16_t>(cell - 1);
        }
    }
    return result;
}();

/// A character that other tables of JIS X 0208 have where Windows has a different one.
struct Alternative {
    char16_t character;
    std::uint16_t code;
};
constexpr std::array alternatives{
    Alternative{0x00A2, 0x8191}, Alternative{0x00A3, 0x8192}, Alternative{0x00AC, 0x81CA},
    Alternative{0x2016, 0x8161}, Alternative{0x2212, 0x817C}, Alternative{0x301C, 0x8160},
};

constexpr char32_t first_katakana = 0xFF61; // of half width
constexpr unsigned first_katakana_code = 0xA1;
constexpr unsigned last_katakana_code = 0xDF;

constexpr bool is_lead(unsigned byte)
{
    return (byte >= 0x81 && byte <= 0x9F) || (byte >= 0xE0 && byte <= 0xFC);
}

constexpr bool is_trail(unsigned byte)
{
    return byte >= 0x40 && byte <= 0xFC && byte != 0x7F;
}

} // namespace

std::uint16_t shift_jis_of(char32_t character)
{
    if (character < 0x80) {
        return static_cast<std::uint16_t>(character);
    }
    const char32_t last_katakana = first_katakana + (last_katakana_code - first_katakana_code);
    if (character >= first_katakana && character <= last_katakana) {
        return static_cast<std::uint16_t>(character - first_katakana + first_katakana_code);
    }
    const auto* const found = std::lower_bound(
        by_character.begin(), by_character.end(), character,
        [](std::uint16_t cell, char32_t wanted) { return shift_jis_cells[cell] < wanted; });
    if (found != by_character.end() && shift_jis_cells[*found] == character) {
        return code_of(*found);
    }
    for (const Alternative& alternative : alternatives) {
        if (alternative.character == character) {
            return alternative.code;
        }
    }
    return shift_jis_middle_dot;
}

ShiftJisCharacter shift_jis_at(std::span<const std::byte> text)
{
    const auto first = std::to_integer<unsigned>(text[0]);
    if (first < 0x80) {
        return {static_cast<char32_t>(first), 1};
    }
    if (first >= first_katakana_code && first <= last_katakana_code) {
        return {first_katakana + (first - first_katakana_code), 1};
    }
    const auto second = text.size() > 1 ? std::to_integer<unsigned>(text[1]) : 0U;
    if (!is_lead(first) || !is_trail(second)) {
        return {replacement_character, 1};
    }
    const auto cell = cell_of(first, second);
    if (cell && shift_jis_cells[*cell] != u' ') {
        return {shift_jis_cells[*cell], 2};
    }
    return {replacement_character, std::size_t{second < 0x80 ? 1U : 2U}};
}

} // namespace busbar::controller::detail

#include "screen.hpp"

#include "tool/printing/display_text.hpp"

namespace busbar::tool::watch {

std::string Screen::line(std::size_t row) const
{
    std::string text;
    for (std::size_t column = 0; column < size_.columns; ++column) {
        text += at(row, column).text;
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
}

void Screen::put(std::size_t row, std::size_t column, std::string_view text, Ink ink)
{
    if (row >= size_.rows) {
        return;
    }
    while (!text.empty() && column < size_.columns) {
        const std::string_view character = take_character(text);
        const std::size_t width = display_width(character);
        if (column + width > size_.columns) {
            return;
        }
        Glyph* const glyph = &glyphs_[row * size_.columns + column];
        if (width > 0) {
            glyph[0] = {std::string{character}, ink};
        } else if (column > 0) {
            Glyph& base = glyph[-1].text.empty() && column > 1 ? glyph[-2] : glyph[-1];
            base.text += character;
        }
        if (width == 2) {
            glyph[1] = {"", ink};
        }
        column += width;
    }
}

void Screen::fill(std::size_t row, Ink ink)
{
    for (std::size_t column = 0; row < size_.rows && column < size_.columns; ++column) {
        glyphs_[row * size_.columns + column] = {" ", ink};
    }
}

} // namespace busbar::tool::watch

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tool/printing/output.hpp"

namespace busbar::tool::watch {

struct Size {
    std::size_t columns;
    std::size_t rows;
    friend bool operator==(const Size&, const Size&) = default;
};

/// The appearance of a piece of text.
struct Ink {
    Style style{Style::Plain};
    bool is_reversed{false};
    friend bool operator==(const Ink&, const Ink&) = default;
};

/// A picture for a terminal, cell by cell.
class Screen {
public:
    struct Glyph {
        /// One character with its combining ones; empty after a wide character.
        std::string text{" "};
        Ink ink{};
    };

    explicit Screen(Size size) : size_{size}, glyphs_(size.columns * size.rows) {}

    [[nodiscard]] Size size() const { return size_; }
    [[nodiscard]] const Glyph& at(std::size_t row, std::size_t column) const
    {
        return glyphs_[row * size_.columns + column];
    }
    /// The row's text without blanks at its end.
    [[nodiscard]] std::string line(std::size_t row) const;

    /// `safe` text, cut at the right edge.
    void put(std::size_t row, std::size_t column, std::string_view text, Ink ink = {});
    /// The whole row in this ink, with nothing on it.
    void fill(std::size_t row, Ink ink);

    struct Place {
        std::size_t row;
        std::size_t column;
    };
    /// Position of the cursor; empty if it is hidden.
    std::optional<Place> cursor;

private:
    Size size_;
    std::vector<Glyph> glyphs_;
};

} // namespace busbar::tool::watch

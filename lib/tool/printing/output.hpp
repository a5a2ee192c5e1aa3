#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace busbar::tool {

/// Blanks between two columns of any table.
inline constexpr std::size_t column_gap = 2;

/// Thrown when the reader of our output has exited, which is an end but not an error.
struct OutputClosed {};

enum class Style : std::uint8_t { Plain, Bold, Dim, Good, Uncertain, Bad };

/// Standard output or standard error. Each line goes out at once. Styles are shown on a terminal
/// only, and not if NO_COLOR is set.
class Output {
public:
    explicit Output(std::FILE* file);

    [[nodiscard]] bool is_terminal() const { return is_terminal_; }
    /// Present width of the terminal; otherwise COLUMNS; otherwise SIZE_MAX, for no limit.
    [[nodiscard]] std::size_t columns() const;
    /// Height of the terminal; SIZE_MAX if it is not one.
    [[nodiscard]] std::size_t rows() const;
    [[nodiscard]] bool has_colour() const { return has_colour_; }
    /// True if lines of a tree may be drawn with characters beyond ASCII.
    [[nodiscard]] bool has_unicode() const { return has_unicode_; }

    /// Throws OutputClosed if the reader has exited, and Failure for other errors. Text that cannot
    /// be written to standard error is lost, because there is no other place for it.
    void write(std::string_view text);
    void line(std::string_view text) { write(std::string{text} + "\n"); }
    /// `text` with the style around it.
    [[nodiscard]] std::string styled(Style style, std::string_view text) const;

private:
    std::FILE* file_;
    bool is_terminal_;
    bool has_colour_;
    bool has_unicode_;
};

} // namespace busbar::tool

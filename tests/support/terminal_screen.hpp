#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace busbar::test {

struct TerminalSize {
    std::size_t columns{80};
    std::size_t rows{24};
};

/// What a user of an xterm sees of the bytes that a program writes (libvterm). Rows and columns
/// count from 0 on.
class TerminalScreen {
public:
    explicit TerminalScreen(TerminalSize size);
    TerminalScreen(const TerminalScreen&) = delete;
    TerminalScreen& operator=(const TerminalScreen&) = delete;
    ~TerminalScreen();

    /// What the terminal answers to the program, mostly nothing.
    [[nodiscard]] std::string take(std::string_view bytes);
    void resize(TerminalSize size);

    [[nodiscard]] TerminalSize size() const;
    /// Without blanks at the end.
    [[nodiscard]] std::string row(std::size_t index) const;
    [[nodiscard]] std::vector<std::string> rows() const;
    /// The first row that has `text` in it; empty if none has.
    [[nodiscard]] std::string row_with(std::string_view text) const;
    /// The rows with text, those at the end left out, each with an end of line.
    [[nodiscard]] std::string text() const;
    [[nodiscard]] bool is_reversed(std::size_t row, std::size_t column) const;
    [[nodiscard]] bool has_colours() const;
    [[nodiscard]] bool is_cursor_visible() const;
    /// True while a program has the whole screen, which comes back as it was.
    [[nodiscard]] bool is_alternate() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace busbar::test

#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace busbar::test {

/// A program in a pseudo-terminal, and what one would see there (libvterm).
class TerminalEmulator {
public:
    struct Size {
        int columns;
        int rows;
    };

    /// Starts `command` with TERM=xterm-256color in UTF-8 and with `variables`, "NAME=value".
    TerminalEmulator(std::vector<std::string> command, Size size,
                     std::vector<std::string> variables = {});
    TerminalEmulator(const TerminalEmulator&) = delete;
    TerminalEmulator& operator=(const TerminalEmulator&) = delete;
    /// Ends the program if it has not ended.
    ~TerminalEmulator();

    void type(const std::string& bytes);
    void resize(Size size);
    void signal(int number);

    /// Shows what comes until `holds`, two minutes at most: false then, or when the program has
    /// ended and it still does not.
    [[nodiscard]] bool wait_until(const std::function<bool()>& holds);
    /// Until a line has this text in it.
    [[nodiscard]] bool wait_for(const std::string& text);
    /// The program's exit code, after what it still had to show; -1 if a signal ended it, or if it
    /// does not end.
    [[nodiscard]] int wait_for_exit();

    [[nodiscard]] Size size() const;
    /// Without blanks at the end.
    [[nodiscard]] std::string line(int row) const;
    [[nodiscard]] std::vector<std::string> lines() const;
    [[nodiscard]] bool is_reversed(int row, int column) const;
    [[nodiscard]] bool has_colours() const;
    [[nodiscard]] bool is_cursor_visible() const;
    [[nodiscard]] bool is_alternate() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::test

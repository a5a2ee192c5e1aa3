#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace busbar::test {

/// What is to run and what it finds there.
struct TerminalProgram {
    /// The program's file and its arguments.
    std::vector<std::string> command;
    std::size_t columns{80};
    std::size_t rows{24};
    /// Besides TERM=xterm-256color, LC_ALL=C.UTF-8 and PATH; nothing else is inherited.
    std::vector<std::pair<std::string, std::string>> environment;
};

/// A program in a pseudo-terminal, and the screen that a user would see. Waits in real time, for
/// conditions only, at most `patience`.
class Terminal {
public:
    static constexpr std::chrono::seconds patience{30};

    explicit Terminal(const TerminalProgram& program);
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;
    /// Kills the program if it still runs.
    ~Terminal();

    /// Takes what the program writes until the screen is as wanted; false if it never is.
    [[nodiscard]] bool wait_until(const std::function<bool(const Terminal&)>& is_wanted);
    /// The same for a text that stands somewhere within one row.
    [[nodiscard]] bool wait_for(std::string_view text);
    /// Until the program ended: its exit code, or 128 and the signal's number; none if it does not
    /// end.
    [[nodiscard]] std::optional<int> wait_for_end();

    /// As if typed: "q", "\x03" for Ctrl+C, "\x1b[A" for the arrow that points up.
    void send(std::string_view keys);
    /// The program is told by SIGWINCH.
    void resize(std::size_t columns, std::size_t rows);

    /// What is on the screen, one string a row, without blanks at the end.
    [[nodiscard]] std::vector<std::string> screen() const;
    /// The text of one row, from 0 on.
    [[nodiscard]] std::string row(std::size_t index) const;
    /// The rows with text, those at the end left out, each with an end of line.
    [[nodiscard]] std::string text() const;
    [[nodiscard]] bool is_bold(std::size_t row, std::size_t column) const;
    /// Rows and columns from 0 on.
    [[nodiscard]] std::pair<std::size_t, std::size_t> cursor() const;
    /// All bytes that the program wrote so far.
    [[nodiscard]] const std::string& written() const { return written_; }

private:
    struct Screen;

    /// Takes what is there within a short time; false when the program has closed the terminal.
    bool take();
    bool reap(bool waits);

    std::unique_ptr<Screen> screen_;
    int terminal_{-1};
    ::pid_t program_{-1};
    bool is_open_{true};
    std::optional<int> status_;
    std::string written_;
};

} // namespace busbar::test

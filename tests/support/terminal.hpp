#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

#include "support/program.hpp"
#include "support/terminal_screen.hpp"

namespace busbar::test {

/// What is to run and what it finds there.
struct TerminalProgram {
    /// The program's file and its arguments.
    std::vector<std::string> command;
    TerminalSize size;
    /// Besides, or instead of, TERM=xterm-256color, LC_ALL=C.UTF-8 and PATH; nothing else is
    /// inherited.
    Environment environment;
};

/// A program in a pseudo-terminal, and the screen that a user would see. Waits in real time, for
/// conditions only, at most `patience`.
class Terminal {
public:
    static constexpr std::chrono::minutes patience{2}; // the machine may have much to do

    explicit Terminal(const TerminalProgram& program);
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;
    /// Kills the program if it still runs.
    ~Terminal();

    /// Takes what the program writes until the screen is as wanted; false if it never is.
    [[nodiscard]] bool wait_until(const std::function<bool()>& is_wanted);
    /// The same for a text that stands somewhere within one row.
    [[nodiscard]] bool wait_for(std::string_view text);
    /// Until the program ended: its exit code, or 128 and the signal's number; none if it does not
    /// end.
    [[nodiscard]] std::optional<int> wait_for_end();

    /// As if typed: "q", "\x03" for Ctrl+C, "\x1b[A" for the arrow that points up.
    void type(std::string_view keys);
    /// The program is told by SIGWINCH.
    void resize(TerminalSize size);
    void signal(int number);
    /// Whether the terminal is in the modes that a shell reads lines in, so that what is typed now
    /// is not taken as keys.
    [[nodiscard]] bool takes_lines() const;
    /// Does what a shell does that finds the program stopped: writes to the screen, and lets the
    /// terminal show what is typed and wait for the end of a line.
    void take_over(std::string_view text);
    /// The terminal is gone, and the program is told by SIGHUP.
    void hang_up();

    [[nodiscard]] const TerminalScreen& screen() const { return screen_; }

private:
    /// Takes what is there within a short time; false when the program has closed the terminal.
    bool take();
    bool reap();
    void write(std::string_view bytes);

    TerminalScreen screen_;
    int terminal_{-1};
    ::pid_t program_{-1};
    bool is_open_{true};
    std::optional<int> status_;
};

} // namespace busbar::test

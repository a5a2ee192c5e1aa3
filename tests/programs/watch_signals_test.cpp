#include <catch2/catch.hpp>

#include <csignal>

#include "programs/watched_machine.hpp"

namespace watch_signals_test {

// What becomes of `busbar watch`, and of the terminal, when a shell stops it and when the terminal
// goes away.

using namespace busbar::test;

namespace {

/// A shell in which somebody watches the machine.
struct Shell {
    Shell()
    {
        std::string line;
        for (const std::string& word : machine.command()) {
            line += word + " ";
        }
        terminal.type(line + "\r");
    }
    /// What it prints is told from what was typed by the value of a variable.
    [[nodiscard]] bool says(const std::string& words, const std::string& text)
    {
        const bool is_ready = terminal.wait_until([&] { return terminal.takes_lines(); });
        terminal.type(words + "\r");
        return is_ready && terminal.wait_for(text);
    }

    Machine machine;
    Terminal terminal{
        {{"/bin/sh", "-i"}, {80, 24}, {{"PS1", "$ "}, {"HOME", machine.scratch.path()}}}};
};

} // namespace

TEST_CASE("Ctrl+Z gives the terminal back until watch goes on", "[watch]")
{
    Shell shell;
    check_screen(shell.terminal, "terminal_80x24.txt");
    shell.terminal.type("\x1a");
    REQUIRE(shell.terminal.wait_for("Stopped"));
    check_given_back(shell.terminal);
    CHECK(shell.says("stty -a", " icanon"));
    CHECK_FALSE(shell.terminal.screen().row_with(" echo ").empty());
    shell.terminal.type("clear; fg\r");
    check_screen(shell.terminal, "terminal_80x24.txt");
    CHECK(shell.terminal.screen().is_alternate());
    CHECK_FALSE(shell.terminal.screen().is_cursor_visible());
    shell.terminal.type("s");
    CHECK(shell.terminal.wait_for("sort: name"));
    shell.terminal.type("q");
    REQUIRE(shell.terminal.wait_until([&] { return !shell.terminal.screen().is_alternate(); }));
    CHECK(shell.says("echo code $?", "code 0"));
    check_given_back(shell.terminal);
}

TEST_CASE("watch fits a terminal that changed while it was stopped", "[watch]")
{
    Shell shell;
    check_screen(shell.terminal, "terminal_80x24.txt");
    shell.terminal.type("\x1a");
    REQUIRE(shell.terminal.wait_for("Stopped"));
    shell.terminal.resize({60, 20});
    shell.terminal.type("fg\r");
    check_screen(shell.terminal, "terminal_60x20.txt");
}

TEST_CASE("watch draws all of it again after a stop that it could not see", "[watch]")
{
    const Machine machine;
    const auto terminal = machine.watch({80, 24});
    check_screen(*terminal, "terminal_80x24.txt");
    terminal->signal(SIGSTOP);
    terminal->take_over("\x1b[7;1Hsomebody else\x1b[8;1Hwrote this");
    REQUIRE_FALSE(terminal->screen().row_with("somebody else").empty());
    terminal->signal(SIGCONT);
    check_screen(*terminal, "terminal_80x24.txt");
    terminal->type("s");
    CHECK(terminal->wait_for("sort: name"));
}

TEST_CASE("watch ends with the terminal that it is in", "[watch]")
{
    const Machine machine;
    const auto terminal = machine.watch({80, 24});
    REQUIRE(terminal->wait_for("BB-0001"));
    terminal->hang_up();
    CHECK(terminal->wait_for_end() == 129);
}

TEST_CASE("the same where SIGHUP is ignored", "[watch]")
{
    const Machine machine;
    std::string command = "trap '' HUP; exec";
    for (const std::string& word : machine.command()) {
        command += " " + word;
    }
    Terminal terminal{{{"/bin/sh", "-c", command}, {80, 24}, {{"HOME", machine.scratch.path()}}}};
    REQUIRE(terminal.wait_for("BB-0001"));
    terminal.hang_up();
    CHECK(terminal.wait_for_end() == 129);
}

TEST_CASE("SIGHUP ends watch, and the terminal is given back", "[watch]")
{
    const Machine machine;
    const auto terminal = machine.watch({80, 24});
    REQUIRE(terminal->wait_for("BB-0001"));
    terminal->signal(SIGHUP);
    CHECK(terminal->wait_for_end() == 129);
    check_given_back(*terminal);
}

} // namespace watch_signals_test

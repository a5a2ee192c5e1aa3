#include <catch2/catch.hpp>

#include <csignal>

#include "programs/watched_machine.hpp"

namespace watch_terminal_test {

// `busbar watch` as it is seen and used in a terminal.

using namespace busbar::test;

namespace {

bool wait_for_row(Terminal& terminal, std::size_t row, const std::string& pattern)
{
    return terminal.wait_until([&] { return matches(terminal.screen().row(row), pattern); });
}

bool wait_for_selected(Terminal& terminal, std::size_t row)
{
    return terminal.wait_until([&] {
        return terminal.screen().is_reversed(row, 0) &&
               !terminal.screen().is_reversed(row == 3 ? 4 : 3, 0);
    });
}

/// The number that Speed has on the screen.
std::string speed_of(const Terminal& terminal)
{
    const std::string line = terminal.screen().row_with("Speed  ");
    return line.substr(0, line.find(' ', line.find_first_of("0123456789", 2)));
}

} // namespace

TEST_CASE("watch fits the terminal, whatever size it gets", "[watch]")
{
    const Machine machine;
    const auto terminal = machine.watch({80, 24});
    check_screen(*terminal, "terminal_80x24.txt");
    CHECK(terminal->screen().is_alternate());
    CHECK_FALSE(terminal->screen().is_cursor_visible());
    terminal->resize({60, 20});
    check_screen(*terminal, "terminal_60x20.txt");
    terminal->resize({200, 60});
    check_screen(*terminal, "terminal_200x60.txt");
    terminal->resize({20, 3});
    CHECK(terminal->wait_until(
        [&] { return terminal->screen().row(1).find("Level") != std::string::npos; }));
    terminal->resize({80, 24});
    check_screen(*terminal, "terminal_80x24.txt");
    terminal->type("q");
    CHECK(terminal->wait_for_end() == 0);
    check_given_back(*terminal);
}

TEST_CASE("keys of watch filter, sort, reverse, pause and move", "[watch]")
{
    const Machine machine;
    const auto terminal = machine.watch({80, 24});
    REQUIRE(terminal->wait_for("BB-0001"));
    terminal->type("/spe");
    REQUIRE(terminal->wait_for("filter: spe"));
    CHECK(terminal->wait_for("1-1 of 1"));
    CHECK(wait_for_row(*terminal, 23, "filter: spe"));
    CHECK(terminal->screen().row_with("Level").empty());
    CHECK(terminal->wait_until([&] { return terminal->screen().is_cursor_visible(); }));
    terminal->type("\x1b");
    CHECK(terminal->wait_for("1-5 of 5"));
    terminal->type("s");
    CHECK(terminal->wait_for("sort: name"));
    CHECK(wait_for_row(*terminal, 7, "Speed ~"));
    terminal->type("r");
    CHECK(terminal->wait_for("sort: name reversed"));
    CHECK(wait_for_row(*terminal, 3, "Speed ~"));
    // Speed counts on, but not in a picture that is paused. What stands at the bottom is drawn
    // last: with the prompt the rest is there.
    terminal->type("p/");
    REQUIRE(terminal->wait_for("PAUSED"));
    REQUIRE(wait_for_row(*terminal, 23, "filter:"));
    const std::string paused = terminal->screen().row_with("Speed");
    terminal->type("\x15\rs/");
    REQUIRE(terminal->wait_for("sort: value"));
    REQUIRE(wait_for_row(*terminal, 23, "filter:"));
    CHECK(terminal->screen().row_with("Speed") == paused);
    terminal->type("\rp");
    CHECK(terminal->wait_until([&] { return terminal->screen().row_with("Speed") != paused; }));
    terminal->type("\x1bOH"); // Home
    CHECK(wait_for_selected(*terminal, 3));
    terminal->type("\x1bOB"); // Down
    CHECK(wait_for_selected(*terminal, 4));
    terminal->type("e");
    CHECK(terminal->wait_until([&] { return terminal->screen().row_with("EVENTS").empty(); }));
    terminal->type("?");
    CHECK(terminal->wait_for("write the value of the variable"));
    terminal->type("?");
    terminal->type("d");
    CHECK(terminal->wait_for("Source time   20"));
    terminal->type("\x1b");
    CHECK(terminal->wait_until([&] { return !terminal->screen().row_with("Level  ").empty(); }));
    terminal->type("\x03");
    CHECK(terminal->wait_for_end() == 130);
    check_given_back(*terminal);
}

TEST_CASE("watch writes a value, and says why if it cannot", "[watch]")
{
    const Machine machine;
    const auto terminal = machine.watch({80, 24});
    REQUIRE(terminal->wait_for("BB-0001"));
    terminal->type("/Recipe\r");
    REQUIRE(terminal->wait_for("1-1 of 1"));
    terminal->type("w");
    REQUIRE(terminal->wait_for("write Recipe (String):"));
    terminal->type("two wordsx\x7f\r");
    CHECK(terminal->wait_for("Recipe: written, Good"));
    CHECK(terminal->wait_for("\"two words\""));
    terminal->type("/\x15"
                   "Serial\r");
    REQUIRE(terminal->wait_for("filter: Serial"));
    terminal->type("\r");
    CHECK(terminal->wait_for("Serial: read only"));
    terminal->type("/\x15"
                   "Level\r");
    REQUIRE(terminal->wait_for("filter: Level"));
    terminal->type("w");
    REQUIRE(terminal->wait_for("(Int32):"));
    terminal->type("many\r");
    CHECK(terminal->wait_for("not written: expected a"));
    terminal->type("w");
    REQUIRE(terminal->wait_for("(Int32):"));
    terminal->type("-7\r");
    CHECK(terminal->wait_until(
        [&] { return terminal->screen().row(3).find(" -7 ") != std::string::npos; }));
    terminal->type("q");
    CHECK(terminal->wait_for_end() == 0);
}

TEST_CASE("watch goes on when the server was lost and is back", "[watch]")
{
    Machine machine;
    const auto terminal = machine.watch({120, 24});
    REQUIRE(terminal->wait_for("BB-0001"));
    REQUIRE(terminal->wait_for("The machine started"));
    CHECK(wait_for_row(*terminal, 1, "connected, no security, anonymous"));
    machine.controller.kill();
    REQUIRE(wait_for_row(*terminal, 1, "lost since %%:%%:%%, ~"));
    terminal->type("s");
    CHECK(terminal->wait_for("sort: name"));
    terminal->type("w");
    CHECK(terminal->wait_for("Level: Bad_"));
    terminal->resize({60, 20});
    CHECK(terminal->wait_until([&] { return terminal->screen().row(2).size() == 60; }));
    CHECK(wait_for_row(*terminal, 1, "lost since %%:%%:%%, ~"));
    const std::string speed = speed_of(*terminal);
    machine.controller.restart();
    REQUIRE(wait_for_row(*terminal, 1, "back since %%:%%:%% after ~"));
    CHECK(terminal->wait_until([&] { return speed_of(*terminal) != speed; }));
    terminal->resize({200, 20});
    CHECK(terminal->wait_for("may have missed "));
    terminal->signal(SIGTERM);
    CHECK(terminal->wait_for_end() == 130);
    check_given_back(*terminal);
}

TEST_CASE("watch has no colour where none is wanted", "[watch]")
{
    const Machine machine;
    const auto plain = machine.watch({80, 24}, {}, {{"NO_COLOR", "1"}});
    const auto coloured = machine.watch({80, 24});
    REQUIRE(plain->wait_for("The machine started"));
    REQUIRE(coloured->wait_for("The machine started"));
    CHECK_FALSE(plain->screen().has_colours());
    CHECK(coloured->screen().has_colours());
}

TEST_CASE("watch shows lines where there is no screen to draw on", "[watch]")
{
    const Machine machine;
    const std::string level = "  /Objects/2:PLC/2:Level  42";
    for (const char* type : {"dumb", "no-such-terminal"}) {
        INFO(type);
        const auto terminal =
            machine.watch({100, 24}, {"--count", "5", "--no-events"}, {{"TERM", type}});
        CHECK(terminal->wait_for_end() == 0);
        CHECK_FALSE(terminal->screen().row_with(level).empty());
        CHECK_FALSE(terminal->screen().is_alternate());
    }
    const auto bounded = machine.watch({100, 24}, {"--below", "/Objects/2:PLC", "--limit", "2"});
    CHECK(bounded->wait_for("3 more Variables are left out"));
    CHECK(bounded->wait_for("1-2 of 2"));
    const auto ending = machine.watch({100, 24}, {"ns=2;s=Level", "--count", "1"});
    CHECK(ending->wait_for_end() == 0);
    check_given_back(*ending);
}

} // namespace watch_terminal_test

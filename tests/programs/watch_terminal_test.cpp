#include <catch2/catch.hpp>

#include <csignal>
#include <fstream>

#include "programs/controllers.hpp"
#include "support/terminal.hpp"

// `busbar watch` as it is seen and used in a terminal.

using namespace busbar::test;

namespace {

constexpr const char* configuration = R"([[endpoint]]
policy = "None"
[users]
anonymous = "write"
[plc]
scan_ms = 20
[[plc.variable]]
name = "Level"
type = "Int32"
initial = 42
[[plc.variable]]
name = "Speed"
type = "Int16"
[[plc.variable]]
name = "Recipe"
type = "String"
initial = "standard"
capacity = 64
[[plc.variable]]
name = "Serial"
type = "String"
initial = "BB-0001"
access = "read"
[[plc.variable]]
name = "Running"
type = "Boolean"
[[plc.program]]
kind = "increment"
target = "Speed"
[[plc.program]]
kind = "toggle"
target = "Running"
period_ms = 1000
[[plc.event]]
variable = "Running"
severity = 700
message = "The machine started"
)";

/// A busbar-controller, and `busbar watch` of it.
class Machine {
public:
    [[nodiscard]] std::string url() const { return "opc.tcp://127.0.0.1:" + controller.port(); }
    [[nodiscard]] std::unique_ptr<Terminal> watch(TerminalSize size,
                                                  const std::vector<std::string>& options = {},
                                                  Environment environment = {}) const
    {
        TerminalProgram program{{BUSBAR, "watch", url(), "--insecure", "--interval", "100"},
                                size,
                                std::move(environment)};
        program.command.insert(program.command.end(), options.begin(), options.end());
        program.environment.emplace_back("HOME", scratch.path());
        return std::make_unique<Terminal>(program);
    }

    ScratchFolder scratch;
    Controller controller{scratch, "screens", configuration};
};

/// Whether a line is as the pattern has it, in which % stands for any one character, ~ for the rest
/// of the line.
bool matches(std::string_view line, std::string_view pattern)
{
    const auto width = [](char lead) {
        const auto byte = static_cast<unsigned char>(lead);
        return byte < 0x80 ? 1U : byte < 0xE0 ? 2U : byte < 0xF0 ? 3U : 4U;
    };
    while (!pattern.empty()) {
        if (pattern[0] == '~') {
            return true;
        }
        const char next = line.empty() ? ' ' : line[0];
        if (pattern[0] != '%' && pattern[0] != next) {
            return false;
        }
        line.remove_prefix(std::min<std::size_t>(pattern[0] == '%' ? width(next) : 1, line.size()));
        pattern.remove_prefix(1);
    }
    return line.empty();
}

std::vector<std::string> read_pattern(const std::string& name)
{
    std::ifstream file{std::string{BUSBAR_SOURCE_DIR} + "/tests/programs/screens/" + name};
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) {
        lines.push_back(line);
    }
    return lines;
}

bool shows(const Terminal& terminal, const std::vector<std::string>& pattern)
{
    const auto lines = terminal.screen().rows();
    return std::equal(lines.begin(), lines.end(), pattern.begin(), pattern.end(), matches);
}

/// Waits for the picture of the file, then says of each line that does not come what it is.
void check_screen(Terminal& terminal, const std::string& name)
{
    const auto pattern = read_pattern(name);
    REQUIRE_FALSE(pattern.empty());
    const bool is_shown = terminal.wait_until([&] { return shows(terminal, pattern); });
    if (!is_shown) {
        const auto lines = terminal.screen().rows();
        std::string text;
        for (std::size_t i = 0; i < lines.size(); ++i) {
            const bool is_good = i < pattern.size() && matches(lines[i], pattern[i]);
            text += (is_good ? "  " : "! ") + lines[i] + "\n";
        }
        FAIL(name << " is not what is seen:\n" << text);
    }
    CHECK(terminal.screen().is_reversed(0, 0));
    CHECK(
        terminal.screen().is_reversed(3, terminal.screen().size().columns - 1)); // the selected row
    CHECK_FALSE(terminal.screen().is_reversed(4, 0));
    CHECK(terminal.screen().is_reversed(terminal.screen().size().rows - 1, 0));
}

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
    const std::string line = terminal.screen().row_with("2:Speed  ");
    return line.substr(0, line.find(' ', line.find_first_of("0123456789", 2)));
}

/// The terminal is as it was before.
void check_given_back(const Terminal& terminal)
{
    CHECK_FALSE(terminal.screen().is_alternate());
    CHECK(terminal.screen().is_cursor_visible());
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
    CHECK(wait_for_row(*terminal, 7, "2:Speed ~"));
    terminal->type("r");
    CHECK(terminal->wait_for("sort: name reversed"));
    CHECK(wait_for_row(*terminal, 3, "2:Speed ~"));
    // Speed counts on, but not in a picture that is paused. What stands at the bottom is drawn
    // last: with the prompt the rest is there.
    terminal->type("p/");
    REQUIRE(terminal->wait_for("PAUSED"));
    REQUIRE(wait_for_row(*terminal, 23, "filter:"));
    const std::string paused = terminal->screen().row_with("2:Speed");
    terminal->type("\x15\rs/");
    REQUIRE(terminal->wait_for("sort: value"));
    REQUIRE(wait_for_row(*terminal, 23, "filter:"));
    CHECK(terminal->screen().row_with("2:Speed") == paused);
    terminal->type("\rp");
    CHECK(terminal->wait_until([&] { return terminal->screen().row_with("2:Speed") != paused; }));
    terminal->type("\x1bOH"); // Home
    CHECK(wait_for_selected(*terminal, 3));
    terminal->type("\x1bOB"); // Down
    CHECK(wait_for_selected(*terminal, 4));
    terminal->type("e");
    CHECK(terminal->wait_until([&] { return terminal->screen().row_with("EVENTS").empty(); }));
    terminal->type("\x03");
    CHECK(terminal->wait_for_end() == 0);
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
    REQUIRE(terminal->wait_for("write 2:Recipe (String):"));
    terminal->type("two wordsx\x7f\r");
    CHECK(terminal->wait_for("2:Recipe: written, Good"));
    CHECK(terminal->wait_for("\"two words\""));
    terminal->type("/\x15"
                   "Serial\r");
    REQUIRE(terminal->wait_for("filter: Serial"));
    terminal->type("\r");
    CHECK(terminal->wait_for("2:Serial: read only"));
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
    CHECK(terminal->wait_for("2:Level: Bad_"));
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
    CHECK(terminal->wait_for_end() == 0);
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

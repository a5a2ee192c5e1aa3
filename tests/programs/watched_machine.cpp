#include "programs/watched_machine.hpp"

#include <algorithm>
#include <fstream>

#include <catch2/catch.hpp>

namespace busbar::test {

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

} // namespace

Machine::Machine() : controller{scratch, "screens", configuration} {}

std::vector<std::string> Machine::command(const std::vector<std::string>& options) const
{
    std::vector<std::string> command{BUSBAR, "watch", url(), "--insecure", "--interval", "100"};
    command.insert(command.end(), options.begin(), options.end());
    return command;
}

std::unique_ptr<Terminal> Machine::watch(TerminalSize size, const std::vector<std::string>& options,
                                         Environment environment) const
{
    environment.emplace_back("HOME", scratch.path());
    return std::make_unique<Terminal>(
        TerminalProgram{command(options), size, std::move(environment)});
}

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

void check_given_back(const Terminal& terminal)
{
    CHECK_FALSE(terminal.screen().is_alternate());
    CHECK(terminal.screen().is_cursor_visible());
}

} // namespace busbar::test

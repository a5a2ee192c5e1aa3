#include <catch2/catch.hpp>

#include <regex>

#include "programs/controllers.hpp"
#include "support/terminal.hpp"

namespace screens_test {

// What `busbar read` shows in terminals of several sizes, cell by cell.

using namespace busbar::test;

namespace {

constexpr TerminalSize sizes[] = {{80, 24}, {60, 20}, {200, 60}};

class Plant {
public:
    Plant()
    {
        std::string values;
        for (int i = 0; i < 1'000; ++i) {
            values += (i == 0 ? "[" : ", ") + std::to_string(i * 7);
        }
        REQUIRE(end_of({"write", "ns=2;s=Curve", values + "]"}) == 0);
        REQUIRE(end_of({"write", "ns=2;s=Grid", "[[1, 2, 3], [40, 50, 60]]"}) == 0);
    }

    [[nodiscard]] TerminalProgram program(std::vector<std::string> arguments,
                                          TerminalSize size = {})
    {
        arguments.insert(arguments.begin(), BUSBAR);
        arguments.emplace_back("--insecure");
        return {std::move(arguments),
                size,
                {{"HOME", scratch_.path()}, {"BUSBAR_URL", controller_.url()}}};
    }
    [[nodiscard]] std::optional<int> end_of(const std::vector<std::string>& arguments)
    {
        return Terminal{program(arguments)}.wait_for_end();
    }
    /// The screen after the program has ended well, with times masked.
    [[nodiscard]] std::string screen_of(const std::vector<std::string>& arguments,
                                        TerminalSize size)
    {
        Terminal terminal{program(arguments, size)};
        CHECK(terminal.wait_for_end() == 0);
        static const std::regex date{"[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9:]{8}[.0-9]*Z"};
        static const std::regex time{"[0-9]{2}:[0-9]{2}:[0-9]{2}\\.[0-9]{3}"};
        const std::string without_dates =
            std::regex_replace(terminal.screen().text(), date, "<date>");
        return std::regex_replace(without_dates, time, "<time>");
    }

private:
    ScratchFolder scratch_;
    Controller controller_{scratch_, "screens", open_configuration() + R"(
[[plc.variable]]
name = "Grid"
type = "Int32"
dimensions = [2, 3]
)"};
};

constexpr const char* insecure =
    "busbar: insecure: no encryption, and the server is not authenticated\n";

constexpr const char* server_status = R"(NODE    VALUE                 SOURCE TIME
i=2256  ServerStatusDataType  <time>
  StartTime            <date>
  CurrentTime          <date>
  State                Running (0)
  BuildInfo            BuildInfo
    ProductUri        "urn:busbar"
    ManufacturerName  "Busbar"
    ProductName       "screens"
    SoftwareVersion   ")" BUSBAR_VERSION R"("
    BuildNumber       ")" BUSBAR_VERSION R"("
    BuildDate         <date>
  SecondsTillShutdown  0
  ShutdownReason       null
)";

/// So many numbers 7 * i in a line, as columns of four with two blanks between them.
std::string curve_lines(int in_line, int count, int index_width)
{
    std::string text;
    char part[32];
    for (int i = 0; i < count; ++i) {
        if (i % in_line == 0) {
            std::snprintf(part, sizeof part, "%s  %-*s", i == 0 ? "" : "\n", index_width,
                          ("[" + std::to_string(i) + "]").c_str());
            text += part;
        }
        std::snprintf(part, sizeof part, "  %*d", count > 143 ? 4 : 3, i * 7);
        text += part;
    }
    return text + "\n";
}

} // namespace

TEST_CASE("a structure has a line for each field in every terminal")
{
    Plant plant;
    for (const TerminalSize& size : sizes) {
        INFO(size.columns << "x" << size.rows);
        const std::string warning = size.columns == 60
                                        ? "busbar: insecure: no encryption, and the server is not\n"
                                          "  authenticated\n"
                                        : insecure;
        CHECK(plant.screen_of({"read", "i=2256"}, size) == warning + server_status);
    }
}

TEST_CASE("an array fills the width of the terminal, up to a limit that is said")
{
    Plant plant;
    const auto shown = [&](TerminalSize size) {
        const std::string screen =
            plant.screen_of({"read", "ns=2;s=Curve", "--limit", "100"}, size);
        const std::size_t second = screen.find("\n  [0]");
        return second == std::string::npos ? screen : screen.substr(second + 1);
    };
    const std::string rest = "  ... 900 more elements, --limit 0 shows them\n";
    CHECK(shown({80, 24}) == curve_lines(14, 100, 4) + rest);
    CHECK(shown({60, 20}) == curve_lines(10, 100, 4) + rest);
    CHECK(shown({200, 60}) == curve_lines(38, 100, 4) + rest);
    const std::string all = plant.screen_of({"read", "ns=2;s=Curve", "--limit", "0"}, {200, 60});
    CHECK(all.find(curve_lines(32, 1'000, 5)) != std::string::npos);
}

TEST_CASE("the rows of a matrix stand below each other")
{
    Plant plant;
    const std::string grid = R"(NODE         VALUE        SOURCE TIME
ns=2;s=Grid  Int32[2][3]  <time>
  [0]   1   2   3
  [1]  40  50  60
)";
    CHECK(plant.screen_of({"read", "ns=2;s=Grid"}, {80, 24}) == insecure + grid);
}

} // namespace screens_test

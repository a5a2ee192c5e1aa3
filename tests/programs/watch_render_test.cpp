#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "tool/watch/render.hpp"
#include "watch_fixture.hpp"

namespace watch_render_test {

using namespace busbar;
using namespace busbar::tool;
using namespace busbar::tool::watch;
using namespace std::chrono_literals;
using busbar::test::at;
using busbar::test::noon;
using busbar::test::value_of;

namespace {

/// A machine with something of everything.
Model machine()
{
    Model model{"opc.tcp://press.example:4840"};
    for (const char* name :
         {"2:Press/2:Speed", "2:Press/2:Running", "2:Press/2:Recipe", "2:Press/2:Axes",
          "2:Press/2:Temperature", "2:Press/2:数量", "2:Press/2:Valve", "2:Press/2:Silent",
          "2:Press/2:Hydraulics/2:Circuit1/2:Accumulator/2:PressureOfNitrogen"}) {
        model.add_row(name);
    }
    model.link().connected("Basic256Sha256 SignAndEncrypt, operator", true, at(0s));
    for (int i = 0; i < 50; ++i) {
        const auto speed = static_cast<std::int16_t>(std::lround(1000 * std::sin(i / 4.0)));
        model.set_value(0, value_of(Variant{speed}), std::to_string(speed), at(i * 100ms));
    }
    model.set_value(1, value_of(Variant{true}), "true", at(4s));
    model.set_value(2, value_of(Variant{String{"two words"}}), "\"two words\"", at(0s));
    model.set_value(3, value_of(Variant{Array<double>{1, 2.5, -90}}),
                    "[1, 2.5, -90, 12.25, 33.125, 81.0625, 12345.75]", at(1s));
    model.set_value(4, value_of(Variant{21.5}, status::Uncertain_LastUsableValue), "21.5", at(3s));
    model.set_value(5, value_of(Variant{std::uint32_t{7}}), "7", at(2s));
    model.set_value(6, value_of(Variant{}, status::Bad_NoCommunication), "Bad_NoCommunication",
                    at(2s));
    model.set_item(8, status::Bad_NodeIdUnknown);
    model.add_event({noon, 100, "Press", "The machine started"});
    model.add_event(
        {DateTime{noon.ticks + 12'345'678}, 700, "Press/Hydraulics", "Pressure is high"});
    return model;
}

Screen picture(Model& model, Size size, Now now = at(5s), bool has_unicode = true)
{
    model.fit(layout_of(model, size).table_rows);
    return render(model, size, now, has_unicode);
}

std::string text_of_screen(const Screen& screen)
{
    std::string text;
    for (std::size_t row = 0; row < screen.size().rows; ++row) {
        text += screen.line(row) + "\n";
    }
    return text;
}

/// The expected picture; what was painted is left in the build tree, to be looked at.
void check_picture(const Screen& screen, const std::string& name)
{
    const std::string painted = text_of_screen(screen);
    std::ofstream{std::string{BUSBAR_BINARY_DIR} + "/" + name} << painted;
    std::ifstream file{std::string{BUSBAR_SOURCE_DIR} + "/tests/programs/screens/" + name};
    REQUIRE(file);
    const std::string expected{std::istreambuf_iterator<char>{file}, {}};
    CHECK(painted == expected);
}

} // namespace

TEST_CASE("the picture of a machine, cell by cell", "[watch]")
{
    Model model = machine();
    check_picture(picture(model, {80, 24}), "watch_80x24.txt");
    check_picture(picture(model, {60, 20}), "watch_60x20.txt");
    check_picture(picture(model, {200, 60}), "watch_200x60.txt");
}

TEST_CASE("a picture has its inks where they belong", "[watch]")
{
    Model model = machine();
    const Screen screen = picture(model, {80, 24});
    CHECK(screen.at(0, 0).ink == Ink{Style::Bold, true});
    CHECK(screen.at(1, 0).ink == Ink{Style::Good});
    CHECK(screen.at(2, 0).ink == Ink{Style::Bold});
    CHECK(screen.at(3, 79).ink.is_reversed); // the selected row, up to its end
    CHECK_FALSE(screen.at(4, 0).ink.is_reversed);
    CHECK(screen.at(23, 79).ink.is_reversed);
    CHECK_FALSE(screen.cursor);
    const std::size_t value = screen.line(2).find("VALUE");
    CHECK(screen.at(9, value).ink == Ink{Style::Bad});
    CHECK(screen.at(7, value).ink == Ink{Style::Uncertain});
}

TEST_CASE("every size has a picture, with the value in it as long as there is room", "[watch]")
{
    Model model = machine();
    for (std::size_t columns = 1; columns <= 210; columns += columns < 12 ? 1 : 7) {
        for (std::size_t rows = 1; rows <= 60; rows += rows < 14 ? 1 : 9) {
            INFO(columns << "x" << rows);
            const Screen screen = picture(model, {columns, rows});
            CHECK(screen.size() == Size{columns, rows});
            const Layout layout = layout_of(model, {columns, rows});
            CHECK(layout.table_rows >= 1);
            CHECK((columns < 20 || layout.columns.value >= 6));
        }
    }
    CHECK(text_of_screen(picture(model, {40, 1})).find("2:Speed") != std::string::npos);
}

TEST_CASE("without characters beyond ASCII there is a picture too", "[watch]")
{
    Model model{"opc.tcp://x:1"};
    model.add_row("Level");
    for (int i = 0; i < 8; ++i) {
        model.set_value(0, value_of(Variant{i}), std::to_string(i), at(0s));
    }
    const std::string text = text_of_screen(picture(model, {80, 24}, at(0s), false));
    CHECK(text.find("_.-~+=*#") != std::string::npos);
    CHECK(std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; }));
}

TEST_CASE("a paused view stays as it is, but for the connection", "[watch]")
{
    Model model = machine();
    model.apply(Action::Pause, at(5s));
    const std::string before = text_of_screen(picture(model, {80, 24}, at(5s)));
    CHECK(before.find("PAUSED") != std::string::npos);
    model.set_value(0, value_of(Variant{std::int16_t{12'345}}), "12345", at(6s));
    model.add_event({noon, 1, "x", "later"});
    CHECK(text_of_screen(picture(model, {80, 24}, at(50s))) == before);
    model.link().lost(status::Bad_Timeout, at(50s));
    CHECK(text_of_screen(picture(model, {80, 24}, at(50s))).find("lost since") !=
          std::string::npos);
    model.apply(Action::Pause, at(51s));
    const std::string after = text_of_screen(picture(model, {80, 24}, at(51s)));
    CHECK(after.find("12345") != std::string::npos);
    CHECK(after.find("later") != std::string::npos);
}

TEST_CASE("the prompt shows the end of what was typed, and the cursor behind it", "[watch]")
{
    Model model = machine();
    model.open_prompt({Prompt::Kind::Write, "write 2:Speed (Int16): ", LineEditor{"12"}});
    const Screen screen = picture(model, {80, 24});
    CHECK(screen.line(23) == "write 2:Speed (Int16): 12");
    REQUIRE(screen.cursor);
    CHECK(screen.cursor->row == 23);
    CHECK(screen.cursor->column == 25);
    model.open_prompt({Prompt::Kind::Write, "w: ", LineEditor{"0123456789abcdefghij"}});
    const Screen narrow = picture(model, {16, 24});
    CHECK(narrow.line(23) == "w: ...bcdefghij");
    CHECK(narrow.cursor->column == 15);
}

TEST_CASE("a refused item tells why, and has a value when it is there again", "[watch]")
{
    Model model{""};
    model.add_row("a");
    model.set_item(0, status::Bad_NodeIdUnknown);
    CHECK(picture(model, {80, 24}).line(3).find("Bad_NodeIdUnknown") != std::string::npos);
    model.set_item(0, StatusCode{});
    CHECK(picture(model, {80, 24}).line(3).find("(waiting)") != std::string::npos);
    model.set_filter("b");
    CHECK(picture(model, {80, 24}).line(3) == "(the filter leaves nothing)");
}

} // namespace watch_render_test

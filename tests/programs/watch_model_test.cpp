#include <catch2/catch.hpp>

#include <limits>

#include "tool/watch/model.hpp"
#include "tool/watch/render.hpp"
#include "watch_fixture.hpp"

namespace watch_model_test {

using namespace busbar;
using namespace busbar::tool;
using namespace busbar::tool::watch;
using namespace std::chrono_literals;
using busbar::test::at;
using busbar::test::noon;
using busbar::test::value_of;

namespace {

Key character(const char* text)
{
    return {Key::Kind::Character, text};
}

std::vector<std::string> names_shown(const Model& model)
{
    std::vector<std::string> names;
    for (const std::size_t row : model.order()) {
        names.push_back(model.rows()[row].name);
    }
    return names;
}

} // namespace

TEST_CASE("a trend is what the last numbers were", "[watch]")
{
    using Levels = std::vector<std::uint8_t>;
    History history;
    CHECK(history.levels(4).empty());
    history.add(5);
    history.add(5);
    CHECK(history.levels(4) == Levels{1, 1});
    history.add(std::numeric_limits<double>::quiet_NaN());
    history.add(std::numeric_limits<double>::infinity());
    history.add(12);
    CHECK(history.levels(9) == Levels{1, 1, 0, 0, 8});
    CHECK(history.levels(2) == Levels{0, 1});
    history.add(-std::numeric_limits<double>::max());
    history.add(std::numeric_limits<double>::max());
    CHECK(history.levels(2) == Levels{1, 8});
    for (int i = 0; i < 1'000; ++i) {
        history.add(i);
    }
    CHECK(history.levels(SIZE_MAX).size() == History::capacity);
    CHECK(number_of(Variant{std::uint8_t{3}}) == 3);
    CHECK(number_of(Variant{2.5F}) == 2.5);
    CHECK_FALSE(number_of(Variant{true}));
    CHECK_FALSE(number_of(Variant{Array<double>{1}}));
    CHECK_FALSE(number_of(Variant{String{"1"}}));
}

TEST_CASE("names are as short as they can be", "[watch]")
{
    using Names = std::vector<std::string>;
    const ShortNames press =
        short_names({"4:Press/4:GlobalVars/4:Mode", "4:Press/4:GlobalVars/4:Part/2:Count"});
    CHECK(press.folder == "Press/GlobalVars");
    CHECK(press.names == Names{"Mode", "Part/Count"});
    // Numbers of namespaces stay where they make the difference.
    const ShortNames same = short_names({"2:Press/2:Mode", "2:Press/3:Mode", "2:Press/2:Time"});
    CHECK(same.folder == "2:Press");
    CHECK(same.names == Names{"2:Mode", "3:Mode", "2:Time"});
    CHECK(short_names({"2:Press/2:Mode"}).names == Names{"Press/Mode"});
    CHECK(short_names({"ns=2;s=a/b", "ns=2;s=a/c"}).names == Names{"ns=2;s=a/b", "ns=2;s=a/c"});
    CHECK(short_names({"[ns=2;s=a]/2:b"}).names == Names{"[ns=2;s=a]/2:b"});
    CHECK(short_names({"2:A&/b/2:c", "2:A&/b/2:d"}).folder == "A&/b");
    CHECK(short_names({"2:A&/b", "2:A&/c"}).folder.empty());
    CHECK(short_names({"12:30", "Part 2:Count"}).names == Names{"30", "Part 2:Count"});
    CHECK(short_names({}).names.empty());
}

TEST_CASE("keys and details take the place of the table", "[watch]")
{
    Model model{"x"};
    model.add_row("Speed");
    model.apply(action_of(character("?")), at(0s));
    CHECK(model.shows_help());
    model.apply(action_of(character("j")), at(0s)); // any key ends it
    CHECK_FALSE(model.shows_help());
    model.apply(action_of(character("d")), at(0s));
    CHECK(model.shows_details());
    model.apply(Action::Cancel, at(0s));
    CHECK_FALSE(model.shows_details());
    CHECK(details_of(model.rows()[0], "/Objects/2:Speed", {}, nullptr, 80) ==
          std::vector<std::string>{"Node          /Objects/2:Speed", "DataType      not known",
                                   "Status        no value yet"});
    model.set_value(0, value_of(Variant{17}), "17", at(0s));
    const auto lines =
        details_of(model.rows()[0], "/Objects/2:Speed", {{}, "Int32", "1/min"}, nullptr, 80);
    CHECK(lines.back() == "Value         17");
    CHECK(lines[2] == "Unit          1/min");
    CHECK(lines[4] == "Source time   2026-11-21T12:00:00Z");
}

TEST_CASE("ages are told in the unit that suits them", "[watch]")
{
    CHECK(age_text(-5s) == "0.0 s");
    CHECK(age_text(200ms) == "0.2 s");
    CHECK(age_text(960ms) == "1 s");
    CHECK(age_text(3'400ms) == "3 s");
    CHECK(age_text(59'990ms) == "1 min");
    CHECK(age_text(150s) == "2 min");
    CHECK(age_text(3h) == "3 h");
    CHECK(age_text(24h * 12) == "12 d");
    CHECK(age_text(Duration::max()).size() <= 8);
}

TEST_CASE("the age of a value does not depend on the server's clock being ours", "[watch]")
{
    Model model{""};
    model.add_row("a");
    DataValue value = value_of(Variant{1});
    value.source_timestamp = DateTime::from_unix_seconds(1'000'000'000);
    value.server_timestamp = DateTime::from_unix_seconds(1'000'000'120);
    model.set_value(0, value, "1", at(10s));
    CHECK(at(13s).steady - *model.rows()[0].born == 123s);
    value.server_timestamp = {};
    model.set_value(0, value, "1", at(10s));
    CHECK(at(13s).steady - *model.rows()[0].born == 3s);
    value.source_timestamp = DateTime{1};
    value.server_timestamp = DateTime{DateTime::latest};
    model.set_value(0, value, "1", at(10s)); // no overflow
    CHECK(at(13s).steady - *model.rows()[0].born > 24h * 365 * 99);
}

TEST_CASE("what the connection does stands on one line, the news first", "[watch]")
{
    LinkLine link;
    link.connected("no security, anonymous", false, at(0s));
    CHECK(link.text(at(1s)) == "connected, no security, anonymous");
    CHECK(link.style() == Style::Uncertain);
    link.connected("Basic256Sha256 Sign, anonymous", true, at(0s));
    CHECK(link.style() == Style::Good);
    link.lost(status::Bad_ConnectionClosed, at(10s));
    link.lost(status::Bad_CommunicationError, at(12s)); // the next attempt
    CHECK(link.is_lost());
    CHECK(link.style() == Style::Bad);
    CHECK(link.text(at(14s)) ==
          "lost since 12:00:10, 4 s ago, trying again: Bad_CommunicationError");
    link.connected("Basic256Sha256 Sign, anonymous", true, at(16s));
    CHECK(link.text(at(20s)) ==
          "back since 12:00:16 after 6 s, connected, Basic256Sha256 Sign, anonymous");
    link.missed(at(9s).wall, at(16s).wall, status::Bad_SubscriptionIdInvalid);
    CHECK(link.text(at(20s)) ==
          "back since 12:00:16 after 6 s, may have missed 12:00:09 to 12:00:16 "
          "(Bad_SubscriptionIdInvalid), connected, Basic256Sha256 Sign, anonymous");
    CHECK(link.style() == Style::Uncertain);
}

TEST_CASE("rows are filtered by name and sorted as the user likes", "[watch]")
{
    Model model{""};
    for (const char* name : {"Pump/Speed", "Fan/speed", "Fan/State", "Belt"}) {
        model.add_row(name);
    }
    model.set_value(0, value_of(Variant{9}), "9", at(1s));
    model.set_value(1, value_of(Variant{10}), "10", at(3s));
    model.set_value(2, value_of(Variant{String{"on"}}), "\"on\"", at(2s));
    model.set_item(3, status::Bad_NodeIdUnknown);
    using Names = std::vector<std::string>;
    const Names given{"Pump/Speed", "Fan/speed", "Fan/State", "Belt"};
    CHECK(names_shown(model) == given);
    model.apply(Action::Sort, at(4s));
    CHECK(names_shown(model) == Names{"Belt", "Fan/State", "Fan/speed", "Pump/Speed"});
    model.apply(Action::Sort, at(4s));
    CHECK(names_shown(model) == Names{"Pump/Speed", "Fan/speed", "Belt", "Fan/State"});
    model.apply(Action::Sort, at(4s));
    CHECK(names_shown(model) == Names{"Fan/speed", "Fan/State", "Pump/Speed", "Belt"});
    model.apply(Action::Sort, at(4s));
    CHECK(names_shown(model) == Names{"Belt", "Pump/Speed", "Fan/speed", "Fan/State"});
    model.apply(Action::Sort, at(4s));
    model.apply(Action::Reverse, at(4s));
    CHECK(names_shown(model) == Names{"Belt", "Fan/State", "Fan/speed", "Pump/Speed"});
    model.set_filter("SPEED");
    CHECK(names_shown(model) == Names{"Fan/speed", "Pump/Speed"});
    model.apply(Action::Cancel, at(4s));
    CHECK(model.order().size() == 4);
    model.set_filter("nothing");
    CHECK(model.order().empty());
    CHECK_FALSE(model.selected());
}

TEST_CASE("values that are no numbers do not confuse sorting", "[watch]")
{
    Model model{""};
    for (int i = 0; i < 40; ++i) {
        model.add_row(std::to_string(i));
        const double number = i % 3 == 0 ? std::numeric_limits<double>::quiet_NaN() : 40 - i;
        model.set_value(static_cast<std::size_t>(i), value_of(Variant{number}), "x", at(0s));
    }
    model.apply(Action::Sort, at(0s));
    model.apply(Action::Sort, at(0s));
    REQUIRE(model.sort() == SortBy::Value);
    CHECK(names_shown(model).front() == "38");
}

TEST_CASE("the selected row is seen, wherever it goes", "[watch]")
{
    Model model{""};
    for (int i = 0; i < 100; ++i) {
        model.add_row("row" + std::to_string(1'000 + i));
    }
    const auto selected = [&] {
        model.fit(10);
        return model.rows()[*model.selected()].name;
    };
    CHECK(selected() == "row1000");
    model.apply(Action::Up, at(0s));
    CHECK(selected() == "row1000");
    model.apply(Action::PageDown, at(0s));
    CHECK(selected() == "row1010");
    CHECK(model.top() == 1);
    model.apply(Action::Last, at(0s));
    CHECK(selected() == "row1099");
    CHECK(model.top() == 90);
    model.apply(Action::Down, at(0s));
    CHECK(selected() == "row1099");
    model.apply(Action::Reverse, at(0s));
    CHECK(selected() == "row1099");
    CHECK(model.top() == 0);
    model.set_filter("row105");
    CHECK(selected() == "row1059"); // the first that is left
    model.set_filter("");
    CHECK(selected() == "row1059");
    CHECK(model.top() <= 40);
    CHECK(model.top() + 10 > 40);
}

TEST_CASE("what is typed is edited at its end, character by character", "[watch]")
{
    LineEditor line;
    for (const char* text : {"a", "数", "b"}) {
        CHECK(line.take(character(text)) == LineEditor::State::Editing);
    }
    line.take({Key::Kind::Backspace});
    CHECK(line.text() == "a数");
    line.take({Key::Kind::Backspace});
    CHECK(line.text() == "a");
    line.take({Key::Kind::ClearLine});
    line.take({Key::Kind::Backspace});
    line.take({Key::Kind::Up});
    CHECK(line.text().empty());
    for (std::size_t i = 0; i < 2 * LineEditor::max_bytes; ++i) {
        line.take(character("x"));
    }
    CHECK(line.text().size() == LineEditor::max_bytes);
    CHECK(line.take({Key::Kind::Enter}) == LineEditor::State::Accepted);
    CHECK(line.take({Key::Kind::Escape}) == LineEditor::State::Cancelled);
}

TEST_CASE("keys do what the last line says", "[watch]")
{
    CHECK(action_of(character("q")) == Action::Quit);
    CHECK(action_of(character("/")) == Action::Filter);
    CHECK(action_of({Key::Kind::Enter}) == Action::Write);
    CHECK(action_of({Key::Kind::PageDown}) == Action::PageDown);
    CHECK(action_of(character("é")) == Action::None);
    CHECK(key_help(80) ==
          "q quit  ? help  w write  d details  / filter  s sort  p pause  e events");
    CHECK(key_help(20) == "q quit  ? help");
    CHECK(key_help(3).empty());
}

TEST_CASE("events are bounded, and the newest stand first", "[watch]")
{
    Model model{""};
    for (int i = 0; i < 5'000; ++i) {
        model.add_event({noon, 1, "", std::to_string(i)});
    }
    CHECK(model.events().size() == Model::max_events);
    CHECK(model.events().front().message == "4999");
}

} // namespace watch_model_test

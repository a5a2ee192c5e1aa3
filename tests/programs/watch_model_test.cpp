#include <catch2/catch.hpp>

#include <limits>

#include "watch/history.hpp"
#include "watch/keys.hpp"
#include "watch_fixture.hpp"

using namespace busbar;
using namespace busbar::cli;
using namespace busbar::cli::watch;
using namespace std::chrono_literals;
using test::at;

namespace {

Key character(const char* text)
{
    return {Key::Kind::Character, text};
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
          "q quit  w write  / filter  s sort  p pause  r reverse  e events  Up Down scroll");
    CHECK(key_help(20) == "q quit  w write");
    CHECK(key_help(3).empty());
}

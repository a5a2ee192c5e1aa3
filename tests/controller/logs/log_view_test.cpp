#include <catch2/catch.hpp>

#include "controller/life/logged_life.hpp"

namespace log_view_test {

// From the settings of the execution log to what people see of it.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

namespace {

/// As the server settings say; nothing if it is not to be recorded.
std::unique_ptr<ExecutionLog> log_of(const ExecutionLogSettings& settings, Storage& card,
                                     const WallClock& clock, LogSink& next)
{
    ExecutionLogOptions options;
    options.max_files = settings.files;
    options.max_records = settings.records;
    return settings.is_recorded ? ExecutionLog::create(card, clock, next, options).value()
                                : nullptr;
}

} // namespace

TEST_CASE("Set, put in a card, start, look: the use of the execution log (7-1-2)")
{
    SetClock clock;
    NullLog lines;
    storage::MemoryStorage card;
    ServerSettings settings = LifeFixture::used();
    CHECK(log_of(settings.execution_log, card, clock, lines) == nullptr);
    settings.execution_log = {true, 3, 100};
    const auto log = log_of(settings.execution_log, card, clock, lines);
    REQUIRE(log != nullptr);
    card.set_away(true);
    ServerStub server;
    LifeCycle life{server, clock, *log};
    life.power_on();
    life.initialized(settings);
    CHECK_FALSE(log->write_pending());
    card.set_away(false);
    log->medium_changed(LogMedium::In);
    life.prepared(server.number, life_url);
    REQUIRE(log->write_pending());
    const auto seen = read_execution_log(card, ExecutionLogOptions{}.folder, {}, 10);
    REQUIRE(seen);
    CHECK(lines_of(*seen) == Texts{"SERVER 0001 Start", "SERVER 0004 Prepare", "SERVER 0005 Run"});
}

TEST_CASE_METHOD(LoggedLife, "The log on the card is listed over all its files (3-2-8, 7-1-4)")
{
    log = log_of({true, 3, 100}, card, clock, *event_log);
    for (int i = 0; i < 230; ++i) {
        log->record(published("v" + std::to_string(i), 2, 1, 0).record());
    }
    REQUIRE(log->write_pending());
    const std::string& folder = ExecutionLogOptions{}.folder;
    const auto all = read_execution_log(card, folder, {}, 1'000);
    REQUIRE(all);
    CHECK_FALSE(all->is_cut);
    REQUIRE(all->entries.size() == 230);
    for (std::size_t i = 0; i < all->entries.size(); ++i) {
        CHECK(all->entries[i].serial_number == i);
    }
    CHECK(execution_log_columns(all->entries[229]) ==
          std::array<std::string, 6>{"229", "2017/10/17/14:52:50.747", "SERVER", "0111",
                                     "PublishedVariable", "v229 2Byte 1 0"});
    const auto last = read_execution_log(card, folder, {.text = "V22"}, 5);
    REQUIRE(last);
    CHECK(last->is_cut);
    CHECK(lines_of(*last).front() == "SERVER 0111 PublishedVariable v225 2Byte 1 0");
}

} // namespace log_view_test

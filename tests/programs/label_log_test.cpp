#include "product/model/mapped_model.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace label_log_test {

using namespace busbar;
using namespace busbar::product;
using controller::LabelUpdate;
using controller::MappedErrorCode;

// SH-082679, 8.3: error codes of labels in the log, of which there may be one for each Read.

namespace {

class Lines final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view text) override
    {
        lines.emplace_back(text);
    }

    std::vector<std::string> lines;
};

class Clock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override { return time; }
    void pass(std::int64_t seconds) { time.ticks += seconds * 10'000'000; }

    DateTime time{DateTime::from_unix_seconds(1'700'000'000)};
};

struct Fixture {
    void fail(const std::string& label, const NodeId& node = NodeId{2, 5})
    {
        log.error({MappedErrorCode::OutOfRange, label, &node});
    }
    [[nodiscard]] std::vector<std::string> take() { return std::exchange(lines.lines, {}); }

    Lines lines;
    Clock clock;
    LabelLog log{lines, clock};
};

} // namespace

TEST_CASE_METHOD(Fixture, "8.3 Error codes: one that goes on is told each minute, with its number",
                 "[8.3]")
{
    for (int i = 0; i < 100; ++i) {
        fail("Line.W");
    }
    CHECK(take() == std::vector<std::string>{
                        "error 1A01H: the label's value does not suit the node: Line.W of "
                        "ns=2;i=5"});
    // Each counts for the nodes, where only the last one is.
    CHECK(log.last().error_code == 0x1A01);
    CHECK(log.last().error_count == 100);
    CHECK(log.last().error_time == clock.time);
    CHECK(log.last().error.find("Line.W of ns=2;i=5") != std::string::npos);
    CHECK(log.last().event_code == 0);
    clock.pass(59);
    fail("Line.W");
    CHECK(take().empty());
    clock.pass(1);
    fail("Line.W");
    const auto again = take();
    REQUIRE(again.size() == 2);
    CHECK(again[0] == "100 more errors of labels were not told in the minute before");
    CHECK(again[1].find("1A01H") != std::string::npos);
    // A clock that is set back keeps no error from being told.
    clock.pass(-3'600);
    fail("Line.W");
    CHECK(take().size() == 1);
}

TEST_CASE_METHOD(Fixture, "8.3 Error codes: of many labels the first 20 of a minute", "[8.3]")
{
    for (int i = 0; i < 50; ++i) {
        fail("L" + std::to_string(i));
    }
    const auto first = take();
    REQUIRE(first.size() == 20);
    CHECK(first.back().find("L19 of ns=2;i=5; more are only counted for a minute") !=
          std::string::npos);
    // Labels that are updated are told anew.
    log.label_update(LabelUpdate::Started);
    CHECK(log.last().event_code == 24'000);
    CHECK(log.last().event_time == clock.time);
    fail("L0");
    const auto next = take();
    REQUIRE(next.size() == 3);
    CHECK(next[0] == "30 more errors of labels were not told in the minute before");
    CHECK(next[1].find("24000") != std::string::npos);
}

} // namespace label_log_test

#include <busbar/backend/plan.hpp>

#include <catch2/catch.hpp>

#include <map>
#include <set>

namespace plan_test {

using namespace busbar;
using namespace busbar::backend;

namespace {

constexpr std::uint32_t registers = 1;
constexpr std::uint32_t coils = 2;
constexpr std::uint32_t timers = 3; // of four words each

/// A PLC behind a plan. It counts what it is asked and refuses what it was told to refuse.
class Fixture {
public:
    explicit Fixture(PlanConfig config = {}) : plan{with_rules(std::move(config))} {}

    [[nodiscard]] static PlanConfig with_rules(PlanConfig config)
    {
        if (config.rules.empty()) {
            config.rules = {{.area = registers, .max_read = 10, .max_write = 8, .max_gap = 2},
                            {.area = coils, .max_read = 32, .max_write = 32},
                            {.area = timers, .max_read = 2, .words_per_unit = 4}};
        }
        return config;
    }

    /// The word of an address, which says where it is.
    [[nodiscard]] static std::uint16_t word_at(std::uint32_t area, std::uint32_t offset)
    {
        return static_cast<std::uint16_t>(area * 1000 + offset);
    }
    [[nodiscard]] bool is_refused(const PlanRequest& request) const
    {
        std::size_t units = 0;
        for (const PlanAddress& range : request.ranges) {
            units += range.width;
            for (std::uint32_t i = 0; i < range.width; ++i) {
                if (holes.contains({range.area, range.offset + i})) {
                    return true;
                }
            }
        }
        return units > max_units;
    }
    void serve(const PlanRequest& request)
    {
        if (is_refused(request)) {
            plan.refuse(request.id, status::Bad_OutOfRange, now);
            return;
        }
        std::vector<std::uint16_t> words;
        for (const PlanAddress& range : request.ranges) {
            if (request.is_write) {
                written.push_back({range, request.words, request.mask});
                continue;
            }
            const std::uint32_t per_unit = range.area == timers ? 4 : 1;
            for (std::uint32_t i = 0; i < range.width * per_unit; ++i) {
                words.push_back(word_at(range.area, range.offset * per_unit + i));
            }
        }
        plan.answer(request.id, words, now);
    }
    /// Serves all requests, one at a time.
    std::size_t run()
    {
        std::size_t count = 0;
        while (const auto request = plan.next_request()) {
            asked.push_back(request->ranges);
            serve(*request);
            ++count;
        }
        CHECK_FALSE(plan.has_waiting());
        CHECK(plan.under_way() == 0);
        return count;
    }
    PlanResult read(const std::vector<PlanAddress>& addresses)
    {
        asked.clear();
        const auto batch = plan.read(addresses, now);
        REQUIRE(batch);
        run();
        auto result = plan.next_result();
        REQUIRE(result);
        CHECK(result->batch == *batch);
        CHECK_FALSE(result->is_write);
        CHECK_FALSE(plan.next_result());
        check_words(addresses, *result);
        return std::move(*result);
    }
    /// Every good value has the words of its address, every other one zeros.
    static void check_words(const std::vector<PlanAddress>& addresses, const PlanResult& result)
    {
        REQUIRE(result.values.size() == addresses.size());
        for (std::size_t i = 0; i < addresses.size(); ++i) {
            const auto words = result.words_of(result.values[i]);
            const std::uint32_t per_unit = addresses[i].area == timers ? 4 : 1;
            for (std::uint32_t at = 0; at < words.size(); ++at) {
                const auto expected =
                    word_at(addresses[i].area, addresses[i].offset * per_unit + at);
                CHECK(words[at] == (result.values[i].status.is_good() ? expected : 0));
            }
            if (result.values[i].status.is_good()) {
                CHECK(words.size() == std::size_t{addresses[i].width} * per_unit);
            }
        }
    }
    using Asked = std::vector<std::vector<PlanAddress>>;

    struct Written {
        PlanAddress range;
        std::vector<std::uint16_t> words;
        std::uint16_t mask;
    };

    RequestPlan plan;
    TimePoint now{};
    /// Places that the PLC refuses.
    std::set<std::pair<std::uint32_t, std::uint32_t>> holes{};
    std::size_t max_units{SIZE_MAX};
    Asked asked{};
    std::vector<Written> written{};
};

PlanAddress reg(std::uint32_t offset, std::uint32_t width = 1)
{
    return {registers, offset, width};
}

PlanWrite write_of(PlanAddress address, const std::vector<std::uint16_t>& words)
{
    return {address, words};
}

} // namespace

TEST_CASE("addresses that are near each other are read with one request")
{
    Fixture plc;
    SECTION("equal, overlapping and adjacent ones, in any order")
    {
        const auto result = plc.read({reg(3), reg(1, 2), reg(2, 2), reg(3), reg(4)});
        CHECK(plc.asked == Fixture::Asked{{reg(1, 4)}});
        CHECK(result.values[0].access != 0);
        CHECK(result.values[0].access == result.values[4].access);
    }
    SECTION("gaps up to the configured number of units are bridged")
    {
        plc.read({reg(1), reg(4)});
        CHECK(plc.asked == Fixture::Asked{{reg(1, 4)}});
        const auto result = plc.read({reg(1), reg(5)});
        CHECK(plc.asked == Fixture::Asked{{reg(1)}, {reg(5)}});
        CHECK(result.values[0].access != result.values[1].access);
    }
    SECTION("a request has no more units than the protocol allows")
    {
        plc.read({reg(0, 6), reg(6, 4), reg(10)});
        CHECK(plc.asked == Fixture::Asked{{reg(0, 10)}, {reg(10)}});
    }
    SECTION("areas are apart, and a unit may have several words")
    {
        plc.read({reg(5), {coils, 5, 1}, {timers, 7, 1}, {timers, 8, 1}, {timers, 9, 1}});
        CHECK(plc.asked ==
              Fixture::Asked{{reg(5)}, {{coils, 5, 1}}, {{timers, 7, 2}}, {{timers, 9, 1}}});
    }
    SECTION("at the end of an area")
    {
        plc.read({reg(UINT32_MAX), reg(UINT32_MAX - 1)});
        CHECK(plc.asked == Fixture::Asked{{reg(UINT32_MAX - 1, 2)}});
    }
}

TEST_CASE("a value that is too wide for a request is read in pieces and has no common access")
{
    Fixture plc;
    const auto result = plc.read({reg(100, 25), reg(121)});
    CHECK(plc.asked == Fixture::Asked{{reg(100, 10)}, {reg(110, 10)}, {reg(120, 5)}});
    CHECK(result.values[0].status.is_good());
    CHECK(result.values[0].access == 0);
    CHECK(result.values[1].access != 0);
    plc.holes = {{registers, 124}};
    const auto refused = plc.read({reg(100, 25), reg(121)});
    CHECK(refused.values[0].status == StatusCode{status::Bad_OutOfRange});
    CHECK(refused.values[1].status.is_good());
}

TEST_CASE("ranges go into one request where the protocol has such")
{
    const PlanShare three{.max_ranges = 3, .max_words = 20, .range_cost = 2};
    PlanShare other = three;
    other.group = 1;
    Fixture plc{{.rules = {
                     {.area = registers, .max_read = 20, .max_gap = 1, .read = three},
                     {.area = coils, .max_read = 20, .read = three},
                     {.area = timers, .max_read = 20, .words_per_unit = 4, .read = other},
                 }}};
    plc.read({{coils, 9, 1}, reg(1), reg(50), {timers, 1, 1}, {coils, 50, 1}});
    CHECK(plc.asked ==
          Fixture::Asked{{reg(1), reg(50), {coils, 9, 1}}, {{coils, 50, 1}}, {{timers, 1, 1}}});
    // 2 + 8 and 2 + 8 units; the third does not fit.
    plc.read({reg(1, 8), reg(50, 8), reg(90)});
    CHECK(plc.asked == Fixture::Asked{{reg(1, 8), reg(50, 8)}, {reg(90)}});
    plc.holes = {{registers, 50}};
    const auto result = plc.read({reg(1), reg(50), {coils, 9, 1}});
    CHECK(result.values[0].status.is_good());
    CHECK(result.values[1].status == StatusCode{status::Bad_OutOfRange});
    CHECK(result.values[2].status.is_good());
}

TEST_CASE("an address that no request can have is answered without one")
{
    Fixture plc;
    const auto result = plc.read({reg(1, 0), {77, 1, 1}, reg(UINT32_MAX, 2), reg(1)});
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(result.values[i].status == StatusCode{status::Bad_ConfigurationError});
    }
    CHECK(result.values[3].status.is_good());
    CHECK(plc.asked == Fixture::Asked{{reg(1)}});
    CHECK(plc.read({reg(1, 0)}).values.size() == 1);
    CHECK(plc.read({}).values.empty());
}

TEST_CASE("an address that the PLC refuses is found, and the others keep their values")
{
    Fixture plc;
    const auto hole = GENERATE(range(0U, 10U));
    plc.holes = {{registers, hole}};
    std::vector<PlanAddress> addresses;
    for (std::uint32_t i = 0; i < 10; ++i) {
        addresses.push_back(reg(i));
        addresses.push_back(reg(i));
    }
    const auto check = [&](const PlanResult& result) {
        for (std::uint32_t i = 0; i < 20; ++i) {
            CHECK(result.values[i].status.is_bad() == (i / 2 == hole));
        }
    };
    check(plc.read(addresses));
    CHECK(plc.asked.size() <= 1 + 2 * 4);

    // It is not asked again for a while, nor does it spoil the others.
    check(plc.read(addresses));
    CHECK(plc.asked.size() <= 2);
    for (const auto& ranges : plc.asked) {
        CHECK_FALSE(plc.is_refused({.id = 1, .ranges = ranges}));
    }
    // Then it is asked by itself.
    plc.now += std::chrono::seconds{10};
    check(plc.read(addresses));
    CHECK(std::count(plc.asked.begin(), plc.asked.end(), std::vector{reg(hole)}) == 1);
    CHECK(plc.asked.size() <= 3);
    // And when it is there, it is one of them again.
    plc.now += std::chrono::seconds{10};
    plc.holes.clear();
    CHECK(plc.read(addresses).values[std::size_t{hole} * 2].status.is_good());
    plc.now += std::chrono::minutes{10};
    plc.read(addresses);
    CHECK(plc.asked == Fixture::Asked{{reg(0, 10)}});
}

TEST_CASE("what may not be read between two addresses is left out from then on")
{
    Fixture plc;
    plc.holes = {{registers, 4}};
    const std::vector addresses{reg(1), reg(3), reg(5), reg(7)};
    for (const auto& value : plc.read(addresses).values) {
        CHECK(value.status.is_good());
    }
    CHECK(plc.asked == Fixture::Asked{{reg(1, 7)}, {reg(1, 3)}, {reg(5, 3)}});
    plc.read(addresses);
    CHECK(plc.asked == Fixture::Asked{{reg(1, 3)}, {reg(5, 3)}});
    plc.read({reg(1), reg(5), reg(5, 2)});
    CHECK(plc.asked == Fixture::Asked{{reg(1)}, {reg(5, 2)}});
    plc.now += std::chrono::minutes{10};
    plc.holes.clear();
    plc.read(addresses);
    CHECK(plc.asked == Fixture::Asked{{reg(1, 7)}});
}

TEST_CASE("a PLC that takes less than the protocol allows is asked for less")
{
    Fixture plc;
    plc.max_units = 4;
    std::vector<PlanAddress> addresses;
    for (std::uint32_t i = 0; i < 10; ++i) {
        addresses.push_back(reg(i));
    }
    for (const auto& value : plc.read(addresses).values) {
        CHECK(value.status.is_good());
    }
    plc.read(addresses);
    plc.read(addresses);
    CHECK(plc.asked.size() <= 4);
}

TEST_CASE("a PLC that refuses everything does not get requests without end")
{
    Fixture plc{{.max_isolating = 6}};
    plc.max_units = 0;
    std::vector<PlanAddress> addresses;
    for (std::uint32_t i = 0; i < 100; ++i) {
        addresses.push_back(reg(i * 3));
    }
    const auto result = plc.read(addresses);
    for (const auto& value : result.values) {
        CHECK(value.status == StatusCode{status::Bad_OutOfRange});
    }
    CHECK(plc.asked.size() == 100 / 4 + 6);
}

TEST_CASE("refusals that are remembered have a limit, and can be forgotten")
{
    Fixture plc{{.max_remembered = 2}};
    plc.max_units = 0;
    const std::vector addresses{reg(0), reg(100), reg(200)};
    plc.read(addresses);
    CHECK(plc.asked.size() == 3);
    plc.read(addresses);
    CHECK(plc.asked == Fixture::Asked{{reg(200)}});
    CHECK(plc.plan.counters().remembered == 2);
    plc.plan.forget_refusals();
    plc.read(addresses);
    CHECK(plc.asked.size() == 3);
}

TEST_CASE("batches take turns, and no more requests are under way than the PLC takes")
{
    Fixture plc{{.max_under_way = 2}};
    const auto long_one = plc.plan.read(std::vector{reg(0), reg(100), reg(200)}, plc.now);
    const auto short_one = plc.plan.read(std::vector{reg(300)}, plc.now);
    REQUIRE((long_one && short_one));
    const auto first = plc.plan.next_request();
    const auto second = plc.plan.next_request();
    REQUIRE((first && second));
    CHECK(first->ranges[0] == reg(0));
    CHECK(second->ranges[0] == reg(300));
    CHECK_FALSE(plc.plan.next_request());
    CHECK(plc.plan.under_way() == 2);
    plc.serve(*second);
    CHECK(plc.plan.next_result()->batch == *short_one);
    // An answer twice, and one that was never asked for.
    plc.serve(*second);
    plc.plan.answer(4711, {}, plc.now);
    CHECK(plc.plan.counters().unexpected == 2);
    plc.serve(*first);
    CHECK(plc.run() == 2);
    CHECK(plc.plan.next_result()->batch == *long_one);
}

TEST_CASE("a request that fails takes nothing else with it")
{
    Fixture plc{{.max_under_way = 2}};
    const std::vector addresses{reg(0), reg(1), reg(100)};
    REQUIRE(plc.plan.read(addresses, plc.now));
    const auto first = plc.plan.next_request();
    const auto second = plc.plan.next_request();
    plc.plan.fail(first->id, status::Bad_Timeout);
    plc.serve(*second);
    const auto result = plc.plan.next_result();
    REQUIRE(result);
    CHECK(result->values[0].status == StatusCode{status::Bad_Timeout});
    CHECK(result->values[1].status == StatusCode{status::Bad_Timeout});
    CHECK(result->values[2].status.is_good());
    Fixture::check_words(addresses, *result);
}

TEST_CASE("an answer of another length than asked for is no value")
{
    Fixture plc;
    const std::size_t size = GENERATE(0U, 1U, 3U);
    REQUIRE(plc.plan.read(std::vector{reg(0), reg(1)}, plc.now));
    const auto request = plc.plan.next_request();
    plc.plan.answer(request->id, std::vector<std::uint16_t>(size, 7), plc.now);
    const auto result = plc.plan.next_result();
    REQUIRE(result);
    CHECK(result->values[0].status == StatusCode{status::Bad_DecodingError});
    CHECK(result->values[1].status == StatusCode{status::Bad_DecodingError});
    CHECK(result->words == std::vector<std::uint16_t>{0, 0});
}

TEST_CASE("a refusal that gives no reason is bad all the same")
{
    Fixture plc;
    REQUIRE(plc.plan.read(std::vector{reg(0)}, plc.now));
    plc.plan.refuse(plc.plan.next_request()->id, status::Good, plc.now);
    CHECK(plc.plan.next_result()->values[0].status.is_bad());
}

TEST_CASE("a lost connection ends every batch at once")
{
    Fixture plc{{.max_under_way = 2}};
    REQUIRE(plc.plan.read(std::vector{reg(0), reg(100), reg(200)}, plc.now));
    const std::vector<std::uint16_t> words{7};
    REQUIRE(plc.plan.write(std::vector{write_of(reg(1), words), write_of(reg(5), words)}));
    const auto write = plc.plan.next_request();
    const auto read = plc.plan.next_request();
    REQUIRE((write->is_write && !read->is_write));
    plc.serve(*write);
    plc.serve(*read);
    static_cast<void>(plc.plan.next_request());
    plc.plan.fail_all(status::Bad_NoCommunication);
    CHECK(plc.plan.under_way() == 0);
    CHECK_FALSE(plc.plan.next_request());
    const StatusCode lost{status::Bad_NoCommunication};
    const auto first = plc.plan.next_result();
    CHECK(first->values[0].status.is_good());
    CHECK(first->values[1].status == lost);
    CHECK(first->values[2].status == lost);
    const auto second = plc.plan.next_result();
    CHECK(second->values[0].status.is_good());
    CHECK(second->values[1].status == lost);
    // A late answer finds nothing.
    plc.serve(*read);
    CHECK_FALSE(plc.plan.next_result());
    plc.read({reg(1)});
}

TEST_CASE("writes keep their order, are sent once each and join where they follow one another")
{
    Fixture plc;
    const std::vector<std::uint16_t> one{1};
    const std::vector<std::uint16_t> two{2, 3};
    const auto batch = plc.plan.write(std::vector{write_of(reg(5), one), write_of(reg(6, 2), two),
                                                  write_of(reg(5), two), // has too many words
                                                  write_of(reg(5), one), write_of(reg(5), one),
                                                  write_of(reg(4), one)});
    REQUIRE(batch);
    plc.run();
    REQUIRE(plc.written.size() == 4);
    CHECK(plc.written[0].range == reg(5, 3));
    CHECK(plc.written[0].words == std::vector<std::uint16_t>{1, 2, 3});
    CHECK(plc.written[1].range == reg(5));
    CHECK(plc.written[2].range == reg(5));
    CHECK(plc.written[3].range == reg(4));
    const auto result = plc.plan.next_result();
    REQUIRE(result);
    CHECK(result->is_write);
    CHECK(result->values[0].access == result->values[1].access);
    CHECK(result->values[2].status == StatusCode{status::Bad_ConfigurationError});
    CHECK(result->values[5].status.is_good());
}

TEST_CASE("a write that the PLC refuses does not keep its neighbours from being written")
{
    Fixture plc;
    const std::vector<std::uint16_t> word{9};
    const auto hole = GENERATE(range(0U, 5U));
    plc.holes = {{registers, hole}};
    std::vector<PlanWrite> writes;
    for (std::uint32_t i = 0; i < 5; ++i) {
        writes.push_back(write_of(reg(i), word));
    }
    REQUIRE(plc.plan.write(writes));
    const std::vector<std::uint16_t> other{10};
    REQUIRE(plc.plan.write(std::vector{write_of(reg(0), other)}));
    plc.run();
    const auto result = plc.plan.next_result();
    REQUIRE(result);
    std::set<std::uint32_t> done;
    for (std::uint32_t i = 0; i < 5; ++i) {
        CHECK(result->values[i].status.is_bad() == (i == hole));
    }
    // In the order of their addresses, each once, and before the next batch.
    std::uint32_t next = 0;
    for (const auto& write : plc.written) {
        if (write.words[0] == 10) {
            break;
        }
        CHECK(write.range.offset >= next);
        next = write.range.offset + write.range.width;
    }
    CHECK(plc.plan.next_result()->values[0].status.is_bad() == (hole == 0));
    // A refused write is not remembered.
    plc.holes.clear();
    REQUIRE(plc.plan.write(writes));
    CHECK(plc.run() == 1);
}

TEST_CASE("one write is under way at a time, and reads are not left out for ever")
{
    Fixture plc{{.max_under_way = 4}};
    const std::vector<std::uint16_t> word{1};
    std::vector<PlanWrite> writes;
    for (std::uint32_t i = 0; i < 20; ++i) {
        writes.push_back(write_of(reg(100 - i * 2), word));
    }
    REQUIRE(plc.plan.write(writes));
    const auto first = plc.plan.next_request();
    CHECK(first->is_write);
    CHECK_FALSE(plc.plan.next_request());
    CHECK_FALSE(plc.plan.has_waiting());
    REQUIRE(plc.plan.read(std::vector{reg(1), reg(50)}, plc.now));
    CHECK_FALSE(plc.plan.next_request()->is_write);
    plc.serve(*first);
    std::size_t in_a_row = 0;
    for (auto next = plc.plan.next_request(); next && next->is_write;
         next = plc.plan.next_request()) {
        plc.serve(*next);
        ++in_a_row;
    }
    CHECK(in_a_row == 8);
}

TEST_CASE("a value that is too wide for a write is written in pieces until one fails")
{
    Fixture plc;
    std::vector<std::uint16_t> words(20);
    for (std::uint16_t i = 0; i < 20; ++i) {
        words[i] = i;
    }
    const std::vector<std::uint16_t> one{1};
    const std::vector writes{write_of(reg(0, 20), words), write_of(reg(20), one)};
    REQUIRE(plc.plan.write(writes));
    CHECK(plc.run() == 4);
    CHECK(plc.written[2].range == reg(16, 4));
    CHECK(plc.written[2].words == std::vector<std::uint16_t>{16, 17, 18, 19});
    CHECK(plc.plan.next_result()->values[0].access == 0);

    plc.written.clear();
    plc.holes = {{registers, 10}};
    REQUIRE(plc.plan.write(writes));
    CHECK(plc.run() == 3);
    REQUIRE(plc.written.size() == 2);
    CHECK(plc.written[1].range == reg(20));
    const auto result = plc.plan.next_result();
    CHECK(result->values[0].status == StatusCode{status::Bad_OutOfRange});
    CHECK(result->values[1].status.is_good());
}

TEST_CASE("a write of some bits of a word is a request of its own")
{
    Fixture plc;
    const std::vector<std::uint16_t> word{0x00F0};
    const std::vector<std::uint16_t> two{1, 2};
    REQUIRE(plc.plan.write(std::vector<PlanWrite>{
        {reg(1), word}, {reg(2), word, 0x0FF0}, {reg(3), word}, {reg(4, 2), two, 0x0001}}));
    CHECK(plc.run() == 3);
    CHECK(plc.written[0].mask == 0xFFFF);
    CHECK(plc.written[1].mask == 0x0FF0);
    CHECK(plc.written[1].range == reg(2));
    CHECK(plc.plan.next_result()->values[3].status == StatusCode{status::Bad_ConfigurationError});
}

TEST_CASE("a cancelled batch has no result, and its writes are not sent")
{
    Fixture plc;
    const std::vector<std::uint16_t> word{1};
    const auto writes = plc.plan.write(std::vector{write_of(reg(1), word), write_of(reg(9), word)});
    const auto sent = plc.plan.next_request();
    const auto reads = plc.plan.read(std::vector{reg(1), reg(100)}, plc.now);
    REQUIRE((writes && sent && reads));
    plc.plan.cancel(*writes);
    plc.plan.cancel(*reads);
    plc.plan.cancel(4711);
    CHECK(plc.plan.under_way() == 1);
    plc.serve(*sent);
    CHECK(plc.run() == 0);
    CHECK_FALSE(plc.plan.next_result());
    CHECK(plc.written.size() == 1);
    plc.read({reg(1)});
}

TEST_CASE("batches, addresses and words of a plan have limits")
{
    Fixture plc{{.max_batches = 2, .max_addresses = 5, .max_words = 50}};
    const auto refused = [&](std::vector<PlanAddress> addresses) {
        const auto batch = plc.plan.read(addresses, plc.now);
        return !batch && batch.error() == StatusCode{status::Bad_TooManyOperations};
    };
    CHECK(refused({6, reg(1)}));
    CHECK(refused({reg(1, 51)}));
    CHECK(refused({reg(1, UINT32_MAX)}));
    CHECK(refused({reg(1, 26), reg(1, 26)}));
    REQUIRE(plc.plan.read(std::vector{reg(1, 20), reg(1, 20), reg(1)}, plc.now));
    CHECK(refused({3, reg(1)}));
    CHECK(refused({reg(1, 10)}));
    REQUIRE(plc.plan.read(std::vector{reg(1)}, plc.now));
    CHECK(refused({reg(1)}));
    plc.run();
    // Results that are not taken count, too.
    CHECK(refused({reg(1)}));
    CHECK(plc.plan.next_result());
    CHECK(plc.plan.next_result());
    REQUIRE(plc.plan.read(std::vector{reg(1, 25), reg(1, 25)}, plc.now));
    plc.plan.fail_all(status::Bad_NoCommunication);
    CHECK(plc.plan.next_result());
    const auto cancelled = plc.plan.read(std::vector{reg(1, 50)}, plc.now);
    REQUIRE(cancelled);
    plc.plan.cancel(*cancelled);
    CHECK_FALSE(refused({reg(1, 50)}));
}

} // namespace plan_test

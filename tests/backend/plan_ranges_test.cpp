#include <busbar/backend/plan.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>
#include <set>

namespace plan_ranges_test {

// Requests of several ranges: which ranges go together, and peers that do not have them.

using namespace busbar;
using namespace busbar::backend;

namespace {

constexpr std::uint32_t words = 1;
constexpr std::uint32_t bits = 2;

PlanAddress word(std::uint32_t offset, std::uint32_t width = 1)
{
    return {words, offset, width};
}
PlanAddress bit(std::uint32_t offset, std::uint32_t width = 1)
{
    return {bits, offset, width};
}

using Ranges = std::vector<PlanAddress>;
using Asked = std::vector<Ranges>;

/// Up to three ranges of 20 words, each of which costs 2 more; or 8 words, whatever they are of.
std::vector<PlanRule> rules()
{
    const PlanShare read{.max_ranges = 3, .max_words = 20, .range_cost = 2, .max_listed = 8};
    PlanRule of_words{.area = words, .max_read = 50, .max_write = 50, .max_gap = 1, .read = read};
    of_words.write = read;
    PlanRule of_bits{.area = bits, .max_read = 100, .max_write = 100, .max_gap = 8, .read = read};
    of_bits.read.units_per_word = 16;
    of_bits.write.max_listed = 4;
    of_bits.write.group = 1;
    return {of_words, of_bits};
}

class Peer {
public:
    /// Reads and returns the requests that this took.
    Asked read(const Ranges& addresses)
    {
        const auto batch = plan.read(addresses, {});
        REQUIRE(batch);
        return run();
    }
    Asked write(const Ranges& addresses)
    {
        std::vector<std::vector<std::uint16_t>> values;
        std::vector<PlanWrite> writes;
        values.reserve(addresses.size());
        for (const PlanAddress& address : addresses) {
            auto& of_it = values.emplace_back(address.width);
            std::iota(of_it.begin(), of_it.end(), static_cast<std::uint16_t>(address.offset));
            writes.push_back({address, values.back()});
        }
        REQUIRE(plan.write(writes));
        return run();
    }
    Asked run()
    {
        Asked asked;
        while (const auto request = plan.next_request()) {
            asked.push_back(request->ranges);
            serve(*request);
        }
        auto result = plan.next_result();
        REQUIRE(result);
        last = std::move(*result);
        return asked;
    }
    void serve(const PlanRequest& request)
    {
        if (request.ranges.size() > max_ranges) {
            plan.change_rules(fewer, 1, {});
            plan.plan_again(request.id, {});
            return;
        }
        std::vector<std::uint16_t> numbers;
        for (const PlanAddress& range : request.ranges) {
            for (std::uint32_t i = 0; i < range.width; ++i) {
                numbers.push_back(static_cast<std::uint16_t>(range.offset + i));
            }
        }
        if (std::ranges::any_of(numbers, [&](auto each) { return holes.contains(each); })) {
            plan.refuse(request.id, status::Bad_OutOfRange, {}, 0x4031);
            return;
        }
        if (request.is_write) {
            CHECK(request.words == numbers);
            written.insert(written.end(), numbers.begin(), numbers.end());
            numbers.clear();
        }
        plan.answer(request.id, numbers, {});
    }

    RequestPlan plan{{.rules = rules()}};
    std::set<std::uint32_t> holes{};
    std::size_t max_ranges{SIZE_MAX};
    std::vector<PlanRule> fewer{};
    PlanResult last{};
    std::vector<std::uint32_t> written{};
};

} // namespace

TEST_CASE("scattered words are read together, as ranges or one by one")
{
    Peer peer;
    // More ranges than three, and few enough words to name each.
    CHECK(peer.read({word(1), word(10), word(20), word(30), word(40)}) ==
          Asked{{word(1), word(10), word(20), word(30), word(40)}});
    // Three ranges of 14 words and 6 for the ranges; 15 words are one too many.
    CHECK(peer.read({word(1, 10), word(20, 2), word(30, 2)}) ==
          Asked{{word(1, 10), word(20, 2), word(30, 2)}});
    CHECK(peer.read({word(1, 10), word(20, 2), word(30, 3)}) ==
          Asked{{word(1, 10), word(20, 2)}, {word(30, 3)}});
    // Eight words, and a ninth.
    Ranges nine;
    for (std::uint32_t i = 0; i < 9; ++i) {
        nine.push_back(word(i * 10));
    }
    const auto asked = peer.read(nine);
    REQUIRE(asked.size() == 2);
    CHECK(asked[0].size() == 8);
    // A range that is too long for company is read by itself.
    CHECK(peer.read({word(0, 50), word(100)}) == Asked{{word(0, 50)}, {word(100)}});
    for (const PlanValue& value : peer.last.values) {
        CHECK(value.status.is_good());
    }
}

TEST_CASE("bits count as the words that they are in")
{
    Peer peer;
    // Bits 15 and 16 are in two words.
    CHECK(peer.read({word(0, 6), bit(15, 2), word(20)}) ==
          Asked{{word(0, 6), word(20), bit(15, 2)}});
    CHECK(peer.read({word(0, 6), bit(15, 2), word(20), word(30)}) ==
          Asked{{word(0, 6), word(20), word(30)}, {bit(15, 2)}});
    CHECK(peer.last.words == std::vector<std::uint16_t>{0, 1, 2, 3, 4, 5, 15, 16, 20, 30});
}

TEST_CASE("a place that is refused among several ranges is found, with the peer's own code")
{
    Peer peer;
    peer.holes = {20};
    static_cast<void>(peer.read({word(1), word(10), word(20), word(30)}));
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(peer.last.values[i].status.is_bad() == (i == 2));
        CHECK(peer.last.values[i].code == (i == 2 ? 0x4031 : 0));
    }
    // It is remembered with its code.
    CHECK(peer.read({word(20)}).empty());
    CHECK(peer.last.values[0].code == 0x4031);
}

TEST_CASE("a peer without requests of several ranges is asked for each range")
{
    Peer peer;
    peer.max_ranges = 1;
    peer.fewer = rules();
    for (PlanRule& rule : peer.fewer) {
        rule.read = rule.write = {};
    }
    const Ranges apart{word(1), word(10), word(20)};
    const Asked one_by_one{{word(1)}, {word(10)}, {word(20)}};
    Asked asked = peer.read(apart);
    REQUIRE(asked.size() == 4);
    CHECK(asked[0] == apart);
    CHECK(Asked{asked.begin() + 1, asked.end()} == one_by_one);
    CHECK(peer.last.words == std::vector<std::uint16_t>{1, 10, 20});
    CHECK(peer.read(apart) == one_by_one);

    Peer writer;
    writer.max_ranges = 1;
    writer.fewer = peer.fewer;
    asked = writer.write({word(30), word(10), word(20)});
    REQUIRE(asked.size() == 4);
    CHECK(writer.written == std::vector<std::uint32_t>{30, 10, 20});
    CHECK(writer.last.values[2].status.is_good());
}

TEST_CASE("a peer that refuses the same kind of request again and again is not asked for ever")
{
    Peer peer;
    peer.max_ranges = 1;
    peer.fewer = rules();
    CHECK(peer.read({word(1), word(10), word(20)}).size() == 1);
    CHECK(peer.last.values[1].status == StatusCode{status::Bad_NotSupported});
}

TEST_CASE("the same ranges are asked for by another kind of request that the peer may have")
{
    Peer peer;
    REQUIRE(peer.plan.read(Ranges{word(1), word(10), word(20)}, {}));
    const auto as_a_list = peer.plan.next_request();
    REQUIRE(as_a_list);
    auto without_lists = rules();
    without_lists[0].read.max_listed = 0;
    peer.plan.change_rules(without_lists, 1, {});
    peer.plan.plan_again(as_a_list->id, {});
    const auto as_blocks = peer.plan.next_request();
    REQUIRE(as_blocks);
    CHECK(as_blocks->ranges == as_a_list->ranges);
    peer.plan.plan_again(as_blocks->id, {});
    const auto result = peer.plan.next_result();
    REQUIRE(result);
    CHECK(result->values[2].status == StatusCode{status::Bad_NotSupported});
}

TEST_CASE("what waits is planned again when less is known to be taken")
{
    Peer peer;
    Ranges many;
    for (std::uint32_t i = 0; i < 20; ++i) {
        many.push_back(word(i * 10));
    }
    REQUIRE(peer.plan.read(many, {}));
    const auto first = peer.plan.next_request();
    REQUIRE(first);
    CHECK(first->ranges.size() == 8);
    auto fewer = rules();
    fewer[0].read.max_listed = 2;
    fewer[0].read.max_ranges = 1;
    peer.plan.change_rules(fewer, 1, {});
    peer.serve(*first);
    for (const Ranges& ranges : peer.run()) {
        CHECK(ranges.size() <= 2);
    }
    for (std::size_t i = 0; i < many.size(); ++i) {
        CHECK(peer.last.words[i] == i * 10);
    }
}

TEST_CASE("scattered writes go together in their order, but for what overlaps")
{
    Peer peer;
    CHECK(peer.write({word(40), word(10), word(11), word(20)}) ==
          Asked{{word(40), word(10, 2), word(20)}});
    CHECK(peer.written == std::vector<std::uint32_t>{40, 10, 11, 20});
    // The second write of a place is a request of its own.
    CHECK(peer.write({word(40), word(10), word(40), word(41)}) ==
          Asked{{word(40), word(10)}, {word(40, 2)}});
    // Bits and words do not go together here, and stay in order.
    CHECK(peer.write({word(1), bit(1), bit(5), word(3)}) ==
          Asked{{word(1)}, {bit(1), bit(5)}, {word(3)}});
    CHECK(peer.write({bit(1), bit(5), bit(9), bit(13), bit(17)}) ==
          Asked{{bit(1), bit(5), bit(9), bit(13)}, {bit(17)}});
}

TEST_CASE("a write that is refused among several is found, and the others are written once")
{
    Peer peer;
    const auto hole = GENERATE(0U, 10U, 20U, 30U);
    peer.holes = {hole};
    static_cast<void>(peer.write({word(0), word(10), word(20), word(30)}));
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(peer.last.values[i].status.is_bad() == (i * 10 == hole));
    }
    std::vector<std::uint32_t> others{0, 10, 20, 30};
    std::erase(others, hole);
    CHECK(peer.written == others);
}

} // namespace plan_ranges_test

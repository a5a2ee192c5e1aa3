#include <catch2/catch.hpp>

#include <busbar/model/new_node.hpp>
#include <busbar/server/memory_source.hpp>

#include "support/source_caller.hpp"

namespace memory_source_test {

using namespace busbar;
using namespace busbar::server;

namespace {

class TestClock final : public WallClock {
public:
    DateTime now() const override { return DateTime::from_unix_seconds(seconds); }
    std::int64_t seconds{1000};
};

} // namespace

TEST_CASE("a memory source gives back what it was given")
{
    TestClock clock;
    MemorySource source{clock};
    const auto speed = source.add(std::int16_t{7});
    const auto names = source.add(Array<String>{"a", "b"});
    test::SourceCaller caller{source};
    clock.seconds = 2000;
    source.set(speed, std::int16_t{8}, status::Uncertain_InitialValue);

    const auto values = caller.read({names, speed, 99});
    CHECK(values[0] ==
          DataValue{Variant{Array<String>{"a", "b"}}, {}, DateTime::from_unix_seconds(1000)});
    CHECK(values[1] == DataValue{Variant{std::int16_t{8}}, status::Uncertain_InitialValue,
                                 DateTime::from_unix_seconds(2000)});
    CHECK(values[2].status == status::Bad_NodeIdUnknown);

    // With a time of the caller's, for many values at once.
    source.set(speed, std::int16_t{9}, {}, DateTime::from_unix_seconds(1500));
    CHECK(source.get(speed) ==
          DataValue{Variant{std::int16_t{9}}, {}, DateTime::from_unix_seconds(1500)});
}

TEST_CASE("a memory source is written to, whole or in part")
{
    TestClock clock;
    MemorySource source{clock};
    const auto levels = source.add(Array<double>{1, 2, 3});
    test::SourceCaller caller{source};
    REQUIRE(source.options().writes_ranges);

    const auto range = NumericRange::parse("1:2").value();
    const DataValue part{Variant{Array<double>{8, 9}}};
    CHECK(caller.write({{levels, &range, &part}})[0] == status::Good);
    CHECK(source.get(levels).value == Variant{Array<double>{1, 8, 9}});

    const auto outside = NumericRange::parse("2:3").value();
    CHECK(caller.write({{levels, &outside, &part}})[0] == status::Bad_IndexRangeNoData);

    const DataValue whole{Variant{Array<double>{}}, status::Uncertain_InitialValue,
                          DateTime::from_unix_seconds(5)};
    CHECK(caller.write(levels, whole) == status::Good);
    CHECK(source.get(levels) == whole);
    CHECK(caller.write(99, whole) == status::Bad_NodeIdUnknown);
}

TEST_CASE("a source binds variables once a server has it")
{
    TestClock clock;
    MemorySource first{clock};
    MemorySource source{clock};
    CHECK(source.index() == model::no_source);
    CHECK(source.variable(1.5).value.is_null());

    server::detail::DataSources sources{nullptr};
    CHECK(sources.add(first) == 0);
    CHECK(sources.add(source) == 1);
    CHECK(source.index() == 1);
    const model::BoundValue level = source.variable(2.5);
    CHECK(level.source == 1);
    CHECK(level.value == Variant{2.5});
    CHECK(source.get(level.handle).value == Variant{2.5});
    const model::BoundValue again = source.variable(level.handle, std::int32_t{0});
    CHECK(again.source == 1);
    CHECK(again.handle == level.handle);
    CHECK(again.value == Variant{std::int32_t{0}});
    CHECK(source.get(level.handle).value == Variant{2.5});
}

} // namespace memory_source_test

#include <catch2/catch.hpp>

#include "attribute_fixture.hpp"

using namespace busbar;
using namespace std::chrono_literals;
using busbar::test::AttributeFixture;

TEST_CASE_METHOD(AttributeFixture, "D2: a Read looks nodes up as far as its turn goes")
{
    const NodeId level = add("Level", id::Int32, 5);
    const NodeId name = NodeId{0, id::ObjectsFolder};
    ReadRequest request = read_request({});
    for (int i = 0; i < 1'000; ++i) {
        request.nodes_to_read.push_back(read_value_id(level));
        request.nodes_to_read.push_back(read_value_id(name, AttributeId::BrowseName));
    }
    server::detail::ReadJob job{sources, request};
    CHECK_FALSE(job.is_outdated(space));
    std::size_t turns = 1;
    for (bool is_planned = false; !is_planned; ++turns) {
        REQUIRE(turns < 100);
        server::detail::Turn turn{1'000};
        is_planned = plan(job, turn);
        CHECK(turn.is_over() != is_planned);
        // More nodes and sources may come in between.
        auto& source = make_source<test::KeepingSource>();
        model::NewVariable variable;
        variable.source = sources.add(source);
        variable.data_type = NodeId{0, id::Int32};
        request.nodes_to_read[1'999] =
            read_value_id(add(("New" + std::to_string(turns)).c_str(), variable));
        CHECK_FALSE(job.is_outdated(space));
    }
    CHECK(turns > 20);
    memory.set(0, 6);
    REQUIRE_FALSE(job.start(owner, TimePoint{}));
    CHECK(job.handle_deadline(TimePoint{1h}));
    const auto values = results(job);
    REQUIRE(values.size() == 2'000);
    CHECK(values[0] == DataValue{Variant{6}});
    CHECK(values[1] == DataValue{Variant{QualifiedName{0, "Objects"}}});
    CHECK(values[1'998] == DataValue{Variant{6}});
    CHECK(values[1'999].status == status::Bad_Timeout);
}

TEST_CASE_METHOD(AttributeFixture, "D2: a Read sees that what it looked up is gone")
{
    const NodeId level = add("Level", id::Int32, 5);
    const ReadRequest request = read_request({read_value_id(level), read_value_id(level)});
    server::detail::ReadJob job{sources, request};
    server::detail::Turn turn{1};
    REQUIRE_FALSE(plan(job, turn));
    CHECK_FALSE(job.is_outdated(space));
    SECTION("removed")
    {
        REQUIRE(space.remove(space.find(level)));
    }
    SECTION("bound elsewhere")
    {
        space.bind(space.find(level), 0, 0);
    }
    CHECK(job.is_outdated(space));
}

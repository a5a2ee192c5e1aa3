#include <catch2/catch.hpp>

#include <algorithm>

#include "attribute_fixture.hpp"

namespace read_turns_test {

using namespace busbar;
using namespace std::chrono_literals;
using busbar::test::AttributeFixture;

TEST_CASE_METHOD(AttributeFixture, "a Read looks nodes up as far as its turn goes")
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

TEST_CASE_METHOD(AttributeFixture, "a Read sees that what it looked up is gone")
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

TEST_CASE_METHOD(AttributeFixture, "a Write refuses a node of a source that is newer than it")
{
    const NodeId level = add("Level", id::Int32, 5);
    WriteRequest request;
    request.nodes_to_write.resize(3);
    for (WriteValue& value : request.nodes_to_write) {
        value.node_id = level;
        value.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        value.value = DataValue{Variant{std::int32_t{7}}};
    }
    server::detail::WriteJob job{sources, request};
    const server::detail::WriteContext context{
        space, sources, {space, user, control}, definitions, server_time};
    server::detail::Turn first{1};
    REQUIRE_FALSE(job.plan(context, first));
    for (int i = 0; i < 40; ++i) { // beyond what a vector has in hand
        auto& source = make_source<test::KeepingSource>();
        source.options_.all_or_nothing = true;
        model::NewVariable variable;
        variable.source = sources.add(source);
        variable.data_type = NodeId{0, id::Int32};
        variable.access_level = model::Access::Read;
        request.nodes_to_write[2].node_id = add(("Late" + std::to_string(i)).c_str(), variable);
    }
    server::detail::Turn second{};
    REQUIRE(job.plan(context, second));
    REQUIRE(job.start(owner, TimePoint{}));
    CHECK(job.result(0) == status::Good);
    CHECK(job.result(2) == status::Bad_NotWritable);
}

TEST_CASE_METHOD(AttributeFixture, "of a value that a range cuts all counts in a turn")
{
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.value_rank = 1;
    variable.value = Variant{Array<std::int32_t>(10'000)};
    variable.access_level = model::Access::ReadWrite;
    const NodeId list = add("List", variable);
    constexpr std::size_t count = 50;
    std::size_t turns = 0;
    SECTION("read")
    {
        ReadRequest request = read_request({});
        request.nodes_to_read.resize(count);
        std::fill(request.nodes_to_read.begin(), request.nodes_to_read.end(),
                  read_value_id(list, AttributeId::Value, "0"));
        server::detail::ReadJob job{sources, request};
        for (bool is_planned = false; !is_planned; ++turns) {
            server::detail::Turn turn{10'000};
            is_planned = plan(job, turn);
        }
        CHECK(results(job)[count - 1].value == Variant{Array<std::int32_t>(1)});
    }
    SECTION("written")
    {
        WriteRequest request;
        request.nodes_to_write.resize(count);
        for (WriteValue& value : request.nodes_to_write) {
            value.node_id = list;
            value.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
            value.index_range = "0";
            value.value = DataValue{Variant{Array<std::int32_t>{7}}};
        }
        server::detail::WriteJob job{sources, request};
        for (bool is_planned = false; !is_planned; ++turns) {
            server::detail::Turn turn{10'000};
            is_planned =
                job.plan({space, sources, {space, user, control}, definitions, server_time}, turn);
        }
        CHECK(read(list, AttributeId::Value, "0").value == Variant{Array<std::int32_t>{7}});
    }
    CHECK(turns == count);
}

} // namespace read_turns_test

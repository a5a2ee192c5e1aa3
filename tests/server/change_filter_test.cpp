#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include "item_fixture.hpp"

namespace change_filter_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

ExtensionObject change_filter(DataChangeTrigger trigger, DeadbandType type = DeadbandType::None,
                              double value = 0)
{
    DataChangeFilter filter;
    filter.trigger = trigger;
    filter.deadband_type = static_cast<std::uint32_t>(type);
    filter.deadband_value = value;
    return ExtensionObject::from(filter);
}

} // namespace

TEST_CASE_METHOD(ItemFixture, "triggers of a DataChangeFilter",
                 "[unit:Monitor Value Change][unit:Monitor Value Change V2]")
{
    SECTION("Status")
    {
        monitor_level([](auto& item) {
            item.requested_parameters.filter = change_filter(DataChangeTrigger::Status);
        });
        CHECK(reported({2}).empty());
        set(0, 3, status::Uncertain_LastUsableValue);
        const auto data = next_data(client, cycle);
        REQUIRE(data.size() == 1);
        CHECK(data[0].value == DataValue{Variant{3}, status::Uncertain_LastUsableValue});
    }
    SECTION("StatusValue")
    {
        monitor_level([](auto& item) {
            item.requested_parameters.filter = change_filter(DataChangeTrigger::StatusValue);
        });
        CHECK(reported({1}).empty()); // a new timestamp
    }
    SECTION("StatusValueTimestamp")
    {
        monitor_level([](auto& item) {
            item.requested_parameters.filter =
                change_filter(DataChangeTrigger::StatusValueTimestamp);
        });
        CHECK(reported({1}).size() == 1);
    }
}

TEST_CASE_METHOD(ItemFixture, "absolute deadbands of numbers",
                 "[unit:Monitored Items Deadband Filter]")
{
    const NodeId flow = add_variable("flow", 1.0, id::Double);
    auto item = item_request(flow);
    item.requested_parameters.filter =
        change_filter(DataChangeTrigger::StatusValue, DeadbandType::Absolute, 2);
    CHECK(monitor(client, id, item).status_code == status::Good);
    CHECK(next_data(client, cycle).size() == 1);
    const auto is_reported = [&](double value) {
        set(1, value);
        return !next_data(client, cycle).empty();
    };
    CHECK_FALSE(is_reported(3));
    CHECK(is_reported(3.1));
    CHECK_FALSE(is_reported(1.1));
    CHECK(is_reported(std::numeric_limits<double>::quiet_NaN()));
    CHECK_FALSE(is_reported(std::numeric_limits<double>::quiet_NaN()));
    CHECK(is_reported(1.1));
    set(1, 1.1, status::Uncertain_LastUsableValue); // a change of status passes
    CHECK(next_data(client, cycle).size() == 1);
}

TEST_CASE_METHOD(ItemFixture, "deadbands of arrays and of unsigned 64-bit numbers")
{
    const NodeId row = add_variable("row", Array<std::int32_t>{1, 2, 3}, id::Int32, 1);
    const NodeId total = add_variable("total", UINT64_MAX, id::UInt64);
    for (const NodeId& node : {row, total}) {
        auto item = item_request(node);
        item.requested_parameters.filter =
            change_filter(DataChangeTrigger::StatusValue, DeadbandType::Absolute, 10);
        CHECK(monitor(client, id, item).status_code == status::Good);
    }
    CHECK(next_data(client, cycle).size() == 2);
    set(1, Array<std::int32_t>{11, -8, 13});
    set(2, UINT64_MAX - 10);
    CHECK(next_data(client, cycle).empty());
    set(1, Array<std::int32_t>{1, 2, 14});
    set(2, UINT64_MAX - 11);
    CHECK(next_data(client, cycle).size() == 2);
    set(1, Array<std::int32_t>{1, 2}); // another length
    CHECK(next_data(client, cycle).size() == 1);
}

TEST_CASE_METHOD(ItemFixture, "a deadband in percent of the EURange, and its change",
                 "[unit:Data Access PercentDeadband]")
{
    auto& space = server.address_space();
    const auto node = space.find(level);
    model::NewNode property;
    property.browse_name = QualifiedName{0, "EURange"};
    property.parent = node;
    model::NewVariable range;
    range.data_type = NodeId{0, id::Range};
    range.value = ExtensionObject::from(Range{0, 200});
    const auto made = space.add_property(property, range);
    REQUIRE(made);
    monitor_level([](auto& item) {
        item.requested_parameters.filter =
            change_filter(DataChangeTrigger::StatusValue, DeadbandType::Percent, 5);
    });
    CHECK(reported({11}).empty());
    CHECK(reported({12}).size() == 1);

    REQUIRE(space.set_value(*made, ExtensionObject::from(Range{0, 20})));
    server.announce_semantics_change(level);
    const auto told = next_data(client, cycle);
    REQUIRE(told.size() == 1);
    CHECK(told[0].value == DataValue{Variant{12}, StatusCode{0x4000}});
    CHECK(reported({14}) == std::vector<DataValue>{Variant{14}});
    server.announce_structure_change(level);
    const auto structure = next_data(client, cycle);
    REQUIRE(structure.size() == 1);
    CHECK(structure[0].value.status == StatusCode{0x8000});
}

TEST_CASE_METHOD(ItemFixture, "a range of an array is an item of its own")
{
    const NodeId row = add_variable("row", Array<std::int32_t>{1, 2, 3}, id::Int32, 1);
    auto item = item_request(row);
    item.item_to_monitor.index_range = "1:2";
    CHECK(monitor(client, id, item).status_code == status::Good);
    auto data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value == DataValue{Variant{Array<std::int32_t>{2, 3}}});
    set(1, Array<std::int32_t>{9, 2, 3});
    CHECK(next_data(client, cycle).empty());
    set(1, Array<std::int32_t>{9}); // nothing is left in the range
    data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value == DataValue{status::Bad_IndexRangeNoData});
}

} // namespace change_filter_test

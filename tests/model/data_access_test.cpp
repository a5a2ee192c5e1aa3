#include <catch2/catch.hpp>

#include <limits>
#include <set>

#include <busbar/model/data_access.hpp>

#include "model_fixture.hpp"

namespace busbar::model::data_access_test {

namespace {

struct DataAccessFixture : ModelFixture {
    template <typename T>
    [[nodiscard]] T structure(NodeIndex node, const char* property) const
    {
        const Variant value = space.value(find_by_path(space, node, property));
        const auto* const object = value.get_if<ExtensionObject>();
        REQUIRE(object != nullptr);
        REQUIRE(object->get_if<T>() != nullptr);
        return *object->get_if<T>();
    }
    template <typename T>
    [[nodiscard]] T property(NodeIndex node, const char* name) const
    {
        const NodeIndex found = find_by_path(space, node, name);
        REQUIRE(found != no_node);
        CHECK(space.node_id(space.type_definition(found)).is(id::PropertyType));
        const Variant value = space.value(found);
        REQUIRE(value.get_if<T>() != nullptr);
        return *value.get_if<T>();
    }
    [[nodiscard]] bool is_of_type(NodeIndex node, std::uint32_t type) const
    {
        return space.node_id(space.type_definition(node)).is(type);
    }
};

} // namespace

TEST_CASE("UnitIds are the characters of the common code")
{
    // Part 8, 5.6.3.4.
    CHECK(unit_id("C81") == 4405297);
    CHECK(unit_id("MMT") == 5066068);
    CHECK(unit_id("FAH") == 4604232);
    CHECK(unit_id("4H") == 13384);
    CHECK(unit_id("") == -1);
    CHECK(unit_id("MMTX") == -1);
    CHECK(unit_id("mmt") == -1);

    std::set<std::string_view> codes;
    for (const Unit& unit : common_units()) {
        INFO(unit.common_code);
        CHECK(codes.insert(unit.common_code).second);
        CHECK(unit_id(unit.common_code) > 0);
        CHECK_FALSE(unit.symbol.empty());
        CHECK_FALSE(unit.name.empty());
    }
    CHECK(codes.size() >= 60);
    const EUInformation celsius = engineering_units("CEL");
    CHECK(celsius.namespace_uri == "http://www.opcfoundation.org/UA/units/un/cefact");
    CHECK(celsius.display_name.text == "°C");
    CHECK(celsius.description.text == "degree Celsius");
    CHECK(engineering_units("X1").unit_id == 22577);
    CHECK(engineering_units("X1").display_name.text == "X1");
    CHECK(engineering_units("furlong").unit_id == -1);
}

TEST_CASE_METHOD(DataAccessFixture, "An analog item has its ranges and its unit",
                 "[unit:Data Access AnalogItemType][unit:Data Access AnalogItems]"
                 "[unit:Data Access AnalogUnitRangeType][unit:Data Access AnalogUnitType]"
                 "[unit:Data Access DataItems][unit:Base Info Engineering Units]")
{
    AnalogItem item;
    item.variable.data_type = NodeId{0, id::Double};
    item.variable.value = Variant{12.5};
    item.eu_range = Range{0, 400};
    item.engineering_units = engineering_units("CMT");
    item.instrument_range = Range{-10, 500};
    item.value_precision = 0.5;
    item.definition = "a + b";
    const NodeIndex level = add_analog_item(space, named("Level", objects), item).value();
    CHECK(is_of_type(level, id::AnalogItemType));
    CHECK(structure<Range>(level, "EURange") == Range{0, 400});
    CHECK(structure<EUInformation>(level, "EngineeringUnits").unit_id == unit_id("CMT"));
    CHECK(structure<Range>(level, "InstrumentRange") == Range{-10, 500});
    CHECK(property<double>(level, "ValuePrecision") == 0.5);
    CHECK(property<String>(level, "Definition") == "a + b");
    CHECK(*space.value(level).get_if<double>() == 12.5);

    SECTION("without what is Optional")
    {
        AnalogItem plain;
        plain.variable.data_type = NodeId{0, id::Int16};
        plain.eu_range = Range{0, 1};
        const NodeIndex node = add_analog_item(space, named("Plain", objects), plain).value();
        CHECK(children(node) == std::vector<std::string>{"EURange"});
    }
    SECTION("of the types with a unit")
    {
        item.type = NodeId{0, id::AnalogUnitRangeType};
        CHECK(is_of_type(add_analog_item(space, named("UnitRange", objects), item).value(),
                         id::AnalogUnitRangeType));
        item.type = NodeId{0, id::AnalogUnitType};
        item.eu_range.reset();
        const NodeIndex node = add_analog_item(space, named("Unit", objects), item).value();
        CHECK(find_by_path(space, node, "EURange") == no_node);
    }
}

TEST_CASE_METHOD(DataAccessFixture, "Data items that make no sense are refused whole")
{
    AnalogItem item;
    item.variable.data_type = NodeId{0, id::Double};
    item.eu_range = Range{0, 1};
    StatusCode expected = status::Bad_NodeAttributesInvalid;
    SECTION("no EURange")
    {
        item.eu_range.reset();
    }
    SECTION("a range upside down")
    {
        item.eu_range = Range{2, 1};
    }
    SECTION("no unit")
    {
        item.type = NodeId{0, id::AnalogUnitRangeType};
    }
    SECTION("text")
    {
        item.variable.data_type = NodeId{0, id::String};
    }
    SECTION("no analog type")
    {
        item.type = NodeId{0, id::TwoStateDiscreteType};
        expected = status::Bad_TypeDefinitionInvalid;
    }
    SECTION("a value of another type")
    {
        item.variable.value = Variant{"text"};
        expected = status::Bad_TypeMismatch;
    }
    const std::size_t before = space.node_count();
    CHECK(status_of(add_analog_item(space, named("Item", objects), item)) == expected);
    CHECK(space.node_count() == before);
}

TEST_CASE_METHOD(DataAccessFixture, "Discrete items have texts for their values",
                 "[unit:Data Access DiscreteItemType][unit:Data Access MultiState]"
                 "[unit:Data Access MultiStateValueDiscrete][unit:Data Access TwoState]"
                 "[unit:Base Info ValueAsText]")
{
    SECTION("two")
    {
        TwoStateItem item;
        item.false_state = LocalizedText{"en", "Open"};
        item.true_state = LocalizedText{"en", "Closed"};
        const NodeIndex node = add_two_state(space, named("Valve", objects), item).value();
        CHECK(is_of_type(node, id::TwoStateDiscreteType));
        CHECK(space.data_type_id(node).is(id::Boolean));
        CHECK(property<LocalizedText>(node, "FalseState") == item.false_state);
        CHECK(property<LocalizedText>(node, "TrueState") == item.true_state);
    }
    SECTION("many in a row")
    {
        MultiStateItem item;
        item.enum_strings = {LocalizedText{"Off"}, LocalizedText{"Slow"}, LocalizedText{"Fast"}};
        const NodeIndex node = add_multi_state(space, named("Fan", objects), item).value();
        CHECK(is_of_type(node, id::MultiStateDiscreteType));
        CHECK(space.value(find_by_path(space, node, "EnumStrings")).array_size() == 3);
        item.variable.data_type = NodeId{0, id::Int32};
        CHECK(status_of(add_multi_state(space, named("Signed", objects), item)) ==
              status::Bad_NodeAttributesInvalid);
    }
    SECTION("with gaps")
    {
        MultiStateValueItem item;
        EnumValueType manual;
        manual.value = 4;
        manual.display_name = LocalizedText{"Manual"};
        EnumValueType automatic;
        automatic.value = 8;
        automatic.display_name = LocalizedText{"Automatic"};
        item.enum_values = {manual, automatic};
        item.variable.value = Variant{std::int32_t{4}};
        const NodeIndex node = add_multi_state_value(space, named("Mode", objects), item).value();
        CHECK(property<LocalizedText>(node, "ValueAsText").text == "Manual");
        REQUIRE(set_multi_state_value(space, node, Variant{std::int32_t{8}}));
        CHECK(property<LocalizedText>(node, "ValueAsText").text == "Automatic");
        REQUIRE(set_multi_state_value(space, node, Variant{std::int32_t{5}}));
        CHECK(property<LocalizedText>(node, "ValueAsText").text.empty());
        CHECK(status_of(set_multi_state_value(space, node, Variant{"8"})) ==
              status::Bad_TypeMismatch);
    }
}

TEST_CASE_METHOD(DataAccessFixture, "Array items know their axes",
                 "[unit:Data Access ArrayItem2Type][unit:Data Access ArrayItemType]"
                 "[unit:Data Access AxisInformationType][unit:Data Access CubeItemType]"
                 "[unit:Data Access ImageItemType]"
                 "[unit:Data Access NDimensionArrayItemType]"
                 "[unit:Data Access XYArrayItemType][unit:Data Access YArrayItemType]")
{
    AxisInformation axis;
    axis.engineering_units = engineering_units("HTZ");
    axis.eu_range = Range{0, 1000};
    axis.title = LocalizedText{"Frequency"};
    axis.axis_steps = {0.0, 500.0, 1000.0};
    ArrayItem item;
    item.variable.data_type = NodeId{0, id::Float};
    item.eu_range = Range{0, 90};
    item.engineering_units = engineering_units("2N");
    item.title = LocalizedText{"Spectrum"};
    item.axis_scale_type = AxisScaleEnumeration::Log;
    item.axes = {axis};
    const auto rank_of = [&](NodeIndex node) { return space.variable(node).value_rank; };

    SECTION("YArray")
    {
        const NodeIndex node = add_array_item(space, named("Spectrum", objects), item).value();
        CHECK(is_of_type(node, id::YArrayItemType));
        CHECK(rank_of(node) == 1);
        CHECK(structure<AxisInformation>(node, "XAxisDefinition") == axis);
        CHECK(property<LocalizedText>(node, "Title").text == "Spectrum");
        CHECK(property<std::int32_t>(node, "AxisScaleType") == 1);
    }
    SECTION("XYArray")
    {
        item.type = NodeId{0, id::XYArrayItemType};
        const NodeIndex node = add_array_item(space, named("Points", objects), item).value();
        CHECK(space.data_type_id(node).is(id::XVType));
    }
    SECTION("Image and Cube")
    {
        item.axes = {axis, axis};
        item.type = NodeId{0, id::ImageItemType};
        CHECK(rank_of(add_array_item(space, named("Image", objects), item).value()) == 2);
        item.axes.push_back(axis);
        item.type = NodeId{0, id::CubeItemType};
        const NodeIndex cube = add_array_item(space, named("Cube", objects), item).value();
        CHECK(rank_of(cube) == 3);
        CHECK(structure<AxisInformation>(cube, "ZAxisDefinition") == axis);
    }
    SECTION("any number")
    {
        item.axes = {axis, axis, axis, axis};
        item.type = NodeId{0, id::NDimensionArrayItemType};
        const NodeIndex node = add_array_item(space, named("Field", objects), item).value();
        CHECK(rank_of(node) == 4);
        CHECK(space.value(find_by_path(space, node, "AxisDefinition")).array_size() == 4);
    }
    SECTION("too few")
    {
        item.type = NodeId{0, id::ImageItemType};
        CHECK(status_of(add_array_item(space, named("Image", objects), item)) ==
              status::Bad_NodeAttributesInvalid);
    }
}

TEST_CASE_METHOD(DataAccessFixture, "Array items that make no sense are refused whole")
{
    AxisInformation axis;
    axis.eu_range = Range{0, 1000};
    ArrayItem item;
    item.variable.data_type = NodeId{0, id::Float};
    item.eu_range = Range{0, 90};
    item.instrument_range = Range{-1, 100};
    item.axes = {axis};
    const ArrayItem sound = item;
    StatusCode expected = status::Bad_NodeAttributesInvalid;
    SECTION("a range upside down")
    {
        item.eu_range = Range{2, 1};
    }
    SECTION("an instrument's range upside down")
    {
        item.instrument_range = Range{2, 1};
    }
    SECTION("an axis upside down")
    {
        item.axes[0].eu_range = Range{2, 1};
    }
    SECTION("a range without end")
    {
        item.axes[0].eu_range.high = std::numeric_limits<double>::quiet_NaN();
    }
    SECTION("no axis of any number")
    {
        item.axes = Array<AxisInformation>{};
        item.type = NodeId{0, id::NDimensionArrayItemType};
    }
    SECTION("no type of arrays")
    {
        item.type = NodeId{0, id::DataItemType};
    }
    SECTION("a value of another type")
    {
        item.variable.value = Variant{Array<std::int32_t>{1}};
        expected = status::Bad_TypeMismatch;
    }
    const std::size_t before = space.node_count();
    CHECK(status_of(add_array_item(space, named("Item", objects), item)) == expected);
    CHECK(space.node_count() == before);
    const NodeIndex node = add_array_item(space, named("Item", objects), sound).value();
    CHECK(structure<Range>(node, "InstrumentRange") == Range{-1, 100});
}

} // namespace busbar::model::data_access_test

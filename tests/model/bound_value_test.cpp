#include <catch2/catch.hpp>

#include <array>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "model_fixture.hpp"

namespace busbar::model::bound_value_test {

namespace {

struct BoundFixture : ModelFixture {
    VariableAttributes added(const BoundValue& value)
    {
        return space.variable(space.add_variable(objects, {ns, "v"}, value).value());
    }
    [[nodiscard]] StatusCode refusal(NodeIndex parent, const char* name, const BoundValue& value)
    {
        return status_of(space.add_variable(parent, {ns, name}, value));
    }
};

} // namespace

TEST_CASE_METHOD(BoundFixture, "A Variable is added in one statement")
{
    const auto speed =
        space.add_variable(objects, {ns, "Speed"}, BoundValue{1480.0, 2, 7}, Access::ReadWrite);
    REQUIRE(speed);
    CHECK(space.node_id(*speed) == NodeId{ns, "Speed"});
    CHECK(space.browse_name(*speed) == QualifiedName{ns, "Speed"});
    CHECK(space.type_definition(*speed) == space.find(id::BaseDataVariableType));
    const VariableAttributes attributes = space.variable(*speed);
    CHECK(attributes.data_type == space.find(id::Double));
    CHECK(attributes.value_rank == -1);
    CHECK(attributes.array_dimensions.empty());
    CHECK(attributes.access_level == 3);
    CHECK(attributes.user_access_level == 3);
    CHECK(attributes.source == 2);
    CHECK(attributes.handle == 7);
    CHECK(space.value(*speed).is_null()); // the source has it
}

TEST_CASE_METHOD(BoundFixture, "A Variable has the shape of its value")
{
    SECTION("an array")
    {
        const auto attributes = added(Array<std::int16_t>{1, 2, 3});
        CHECK(attributes.data_type == space.find(id::Int16));
        CHECK(attributes.value_rank == 1);
        REQUIRE(attributes.array_dimensions.size() == 1);
        CHECK(attributes.array_dimensions[0] == 3);
        const NodeIndex node = find("v");
        CHECK(space.set_value(node, Array<std::int16_t>{1}));
        CHECK(status_of(space.set_value(node, Array<std::int16_t>{1, 2, 3, 4})) ==
              status::Bad_TypeMismatch);
    }
    SECTION("an array of any length")
    {
        CHECK(added(Array<String>{}).value_rank == 1);
        CHECK(space.set_value(find("v"), Array<String>{"a", "b"}));
    }
    SECTION("a matrix")
    {
        const auto attributes =
            added(Variant::matrix(Array<float>{1, 2, 3, 4, 5, 6}, Array<std::uint32_t>{2, 3}));
        CHECK(attributes.data_type == space.find(id::Float));
        CHECK(attributes.value_rank == 2);
        REQUIRE(attributes.array_dimensions.size() == 2);
        CHECK(attributes.array_dimensions[0] == 2);
        CHECK(attributes.array_dimensions[1] == 3);
    }
    SECTION("a structure")
    {
        const auto attributes = added(ExtensionObject::from(Range{0, 100}));
        CHECK(attributes.data_type == space.find(id::Range));
        CHECK(space.value(find("v")) == Variant{ExtensionObject::from(Range{0, 100})});
    }
    SECTION("structures")
    {
        CHECK(added(Array<ExtensionObject>{ExtensionObject::from(Range{0, 1})}).data_type ==
              space.find(id::Range));
    }
    SECTION("no structure in particular")
    {
        CHECK(added(ExtensionObject{}).data_type == space.find(id::Structure));
    }
    SECTION("an enumeration, which no value shows")
    {
        BoundValue state{std::int32_t{1}};
        state.data_type = NodeId{0, id::ServerState};
        CHECK(added(state).data_type == space.find(id::ServerState));
    }
}

TEST_CASE_METHOD(BoundFixture, "A Variable has the value of a text or container of C++")
{
    const auto kept = [&](const BoundValue& value) {
        return space.value(space.add_variable(objects, {ns, "v"}, value).value());
    };
    SECTION("a std::string")
    {
        CHECK(kept(std::string{"BB-0001"}) == Variant{"BB-0001"});
        CHECK(space.variable(find("v")).data_type == space.find(id::String));
    }
    SECTION("a part of a text")
    {
        CHECK(kept(std::string_view{"BB-0001"}.substr(3)) == Variant{"0001"});
    }
    SECTION("a std::vector of numbers")
    {
        CHECK(kept(std::vector<double>{10, 20, 35.5}) == Variant{Array<double>{10, 20, 35.5}});
        CHECK(space.variable(find("v")).value_rank == 1);
    }
    SECTION("a std::vector<bool>")
    {
        CHECK(kept(std::vector<bool>{true, false}) == Variant{Array<bool>{true, false}});
    }
    SECTION("a std::vector of texts")
    {
        CHECK(kept(std::vector<std::string>{"a", ""}) == Variant{Array<String>{"a", ""}});
    }
    SECTION("a std::array and a std::span")
    {
        const std::array<std::int16_t, 2> numbers{1, 2};
        CHECK(kept(numbers) == Variant{Array<std::int16_t>{1, 2}});
        CHECK(BoundValue{std::span{numbers}}.value == Variant{Array<std::int16_t>{1, 2}});
    }
    SECTION("an empty std::vector, which is an empty array, not null")
    {
        const BoundValue none{std::vector<float>{}};
        REQUIRE(none.value.array_if<float>() != nullptr);
        CHECK_FALSE(none.value.array_if<float>()->is_null());
        CHECK(none.value.array_if<float>()->empty());
    }
    STATIC_REQUIRE_FALSE(std::is_constructible_v<BoundValue, std::vector<void*>>);
    STATIC_REQUIRE_FALSE(std::is_constructible_v<BoundValue, std::vector<std::vector<double>>>);
}

TEST_CASE_METHOD(BoundFixture, "A value without source stays in the address space, read only")
{
    const auto attributes = added("mm");
    CHECK(attributes.source == no_source);
    CHECK(attributes.access_level == 1);
    CHECK(space.value(find("v")) == Variant{"mm"});
}

TEST_CASE_METHOD(BoundFixture, "A Variable's NodeId is its path below nodes with names")
{
    const NodeIndex line = add_folder("Line", objects);
    REQUIRE(space.add_variable(line, {ns, "Speed"}, 1.0));
    CHECK(find("Line/Speed") != no_node);
    // Another namespace begins anew.
    const std::uint16_t other = space.add_namespace("urn:other").value();
    const auto added = space.add_variable(line, {other, "Speed"}, 1.0);
    REQUIRE(added);
    CHECK(space.node_id(*added) == NodeId{other, "Speed"});
}

TEST_CASE_METHOD(BoundFixture, "A Variable that cannot be is refused, and nothing is added")
{
    const std::size_t before = space.node_count();
    CHECK(refusal(no_node, "v", 1.0) == status::Bad_ParentNodeIdInvalid);
    CHECK(refusal(objects, "v", Variant{}) == status::Bad_NodeAttributesInvalid);
    CHECK(refusal(objects, "", 1.0) == status::Bad_NodeIdInvalid);
    BoundValue unknown{1.0};
    unknown.data_type = NodeId{ns, "no type"};
    CHECK(refusal(objects, "v", unknown) == status::Bad_NodeAttributesInvalid);
    BoundValue null{Variant{}};
    null.data_type = NodeId{0, id::Double};
    CHECK(refusal(objects, "v", null) == status::Bad_NodeAttributesInvalid);
    BoundValue contrary{"text"};
    contrary.data_type = NodeId{0, id::Double};
    CHECK(refusal(objects, "v", contrary) == status::Bad_TypeMismatch);
    CHECK(space.node_count() == before);
    REQUIRE(space.add_variable(objects, {ns, "v"}, 1.0));
    CHECK(refusal(objects, "v", 1.0) == status::Bad_NodeIdExists);
}

TEST_CASE("Access has the bits of AccessLevelType")
{
    const auto bits = [](Access access) { return static_cast<unsigned>(access); };
    const auto bit = [](AccessLevelType type) { return static_cast<unsigned>(type); };
    CHECK(bits(Access::Read) == bit(AccessLevelType::CurrentRead));
    CHECK(bits(Access::Write) == bit(AccessLevelType::CurrentWrite));
    CHECK(bits(Access::HistoryRead) == bit(AccessLevelType::HistoryRead));
    CHECK(bits(Access::HistoryWrite) == bit(AccessLevelType::HistoryWrite));
    CHECK(bits(Access::SemanticChange) == bit(AccessLevelType::SemanticChange));
    CHECK(bits(Access::StatusWrite) == bit(AccessLevelType::StatusWrite));
    CHECK(bits(Access::TimestampWrite) == bit(AccessLevelType::TimestampWrite));
    CHECK((Access::Read | Access::Write) == Access::ReadWrite);
    CHECK((Access::All & Access::Write) == Access::Write);
}

} // namespace busbar::model::bound_value_test

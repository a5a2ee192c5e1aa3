#include <catch2/catch.hpp>

#include "shape_fixture.hpp"

namespace value_shape_test {

using namespace busbar;
using namespace busbar::test;

using Paths = std::vector<std::string>;

namespace {

constexpr std::array<std::uint32_t, 1> two{2};
constexpr std::array<std::uint32_t, 2> two_by_three{2, 3};

NodeId standard(std::uint32_t number)
{
    return NodeId{0, number};
}

} // namespace

TEST_CASE_METHOD(ShapeFixture, "8.2 Other DataTypes: subtypes follow their parent", "[8.2]")
{
    const NodeId own_duration = add_subtype("MyDuration", standard(id::Duration));
    const NodeId own_int16 = add_subtype("MyInt16", standard(id::Int16));
    const auto leaf = [&](const NodeId& type) { return shape({type}).leaf_type(0); };
    for (const auto& type : {standard(id::Double), standard(id::Duration), own_duration}) {
        CHECK(leaf(type) == controller::LeafType{BuiltInType::Double, false});
    }
    for (const auto& type : {standard(id::Int16), own_int16}) {
        CHECK(leaf(type) == controller::LeafType{BuiltInType::Int16, false});
    }
    CHECK(leaf(add_enumeration("MyEnumeration", {0, 5})) ==
          controller::LeafType{BuiltInType::Int32, true});
}

TEST_CASE_METHOD(ShapeFixture, "8.2 Other DataTypes: abstract ones cannot be assigned", "[8.2]")
{
    for (const auto type : {id::Number, id::Integer, id::UInteger, id::Enumeration, id::Structure,
                            id::BaseDataType}) {
        CHECK(error({standard(type)}) == number(ShapeError::AbstractType));
    }
    if (space.find(id::Decimal) != model::no_node) {
        CHECK(error({standard(id::Decimal)}) == number(ShapeError::OtherType));
    }
    CHECK(error({own("Missing")}) == number(ShapeError::UnknownType));
    CHECK(error({NodeId{}}) == number(ShapeError::UnknownType));
    CHECK(error({standard(id::ObjectsFolder)}) == number(ShapeError::UnknownType));
}

TEST_CASE_METHOD(ShapeFixture, "8.2 Other DataTypes: none with OptionSetValues", "[8.2]")
{
    const NodeId flags = add_enumeration("Flags", {0, 2}, standard(id::UInt16));
    CHECK(error({flags}) == number(ShapeError::OptionSet));
    CHECK(error({add_subtype("MoreFlags", flags)}) == number(ShapeError::OptionSet));
}

TEST_CASE_METHOD(ShapeFixture, "8.2 Enumeration assignment: the restrictions", "[8.2]")
{
    const NodeId mode = add_enumeration("Mode", {0, 1});
    CHECK(error({mode}) == -1);
    CHECK(error({add_subtype("Lower", mode)}) == number(ShapeError::EnumerationParent));
    CHECK(error({add_enumeration("Signed", {-1, 1})}) == number(ShapeError::EnumerationMinusOne));
    CHECK(error({add_enumeration("Negative", {-2, 1})}) == -1);
}

TEST_CASE_METHOD(ShapeFixture, "8.2 Subtype handling", "[8.2]")
{
    const auto kind = StructureDefinitionType::Structure;
    const NodeId single = add_structure("Single", {field("A", standard(id::Int32))});
    CHECK(error({single}) == -1);
    const NodeId parent = add_structure("Parent", {field("A", standard(id::Int32))});
    const NodeId child = add_structure("Child", {field("B", standard(id::Int32))}, kind, parent);
    CHECK(error({parent}) == number(ShapeError::SubtypedStructure));
    CHECK(error({child}) == number(ShapeError::SubtypedStructure));
    CHECK(error({add_structure("Outer", {field("C", child)})}) ==
          number(ShapeError::SubtypedStructure));
    if (space.find(id::Range) != model::no_node) {
        CHECK(error({standard(id::Range)}) == -1);
        const NodeId below =
            add_structure("MyRange", {field("B", standard(id::Int32))}, kind, standard(id::Range));
        CHECK(error({below}) == -1);
        CHECK(error({standard(id::Range)}) == -1);
    }
}

TEST_CASE_METHOD(ShapeFixture, "8.1 Call: what structures an Argument cannot have", "[8.1]")
{
    const NodeId number_type = standard(id::Int32);
    const NodeId a_union = add_structure("Union", {field("A", number_type)},
                                         StructureDefinitionType::Union, standard(id::Union));
    CHECK(error({a_union}) == number(ShapeError::Union));
    StructureField maybe = field("A", number_type);
    maybe.is_optional = true;
    const NodeId optional =
        add_structure("Optional", {maybe}, StructureDefinitionType::StructureWithOptionalFields);
    CHECK(error({optional}) == number(ShapeError::OptionalFields));
    const NodeId outer = add_structure("Outer", {field("In", optional)});
    const auto refused = try_shape({outer});
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().path == ".In");
    CHECK(refused.error().text == "DataType ns=1;s=Optional (Optional) has optional fields");
}

TEST_CASE_METHOD(ShapeFixture, "8.2 Structure assignment: fields of other ranks spoil all", "[8.2]")
{
    const NodeId matrix = add_structure("Matrix", {field("M", standard(id::Int32), 2)});
    CHECK(error({matrix}) == number(ShapeError::FieldRank));
    CHECK(error({add_structure("Outer", {field("A", standard(id::Int32)), field("In", matrix)})}) ==
          number(ShapeError::FieldRank));
}

TEST_CASE_METHOD(ShapeFixture, "8.2 Array handling: the leaves of arrays", "[8.2]")
{
    const NodeId type = standard(id::Int32);
    CHECK(paths(shape({type})) == Paths{""});
    CHECK(paths(shape({type, 1, two})) == Paths{"[0]", "[1]"});
    CHECK(paths(shape({type, 2, two_by_three})) ==
          Paths{"[0][0]", "[0][1]", "[0][2]", "[1][0]", "[1][1]", "[1][2]"});
    CHECK(paths(shape({type, -2}, {{"", 2, {1, 2}}})) == Paths{"[0][0]", "[0][1]"});
    CHECK(error({type, 4}) == number(ShapeError::ArrayRank));
    constexpr std::array<std::uint32_t, 1> large{10'241};
    CHECK(error({type, 1, large}, ShapeLimits::rd81opc96()) == number(ShapeError::ArraySize));
}

TEST_CASE_METHOD(ShapeFixture, "8.2 Structure assignment: leaves of structures and arrays", "[8.2]")
{
    const NodeId type = standard(id::Int32);
    const NodeId inner = add_structure("Inner", {field("A", type), field("B", type, 1, {2})});
    const NodeId outer = add_structure("Outer", {field("X", type), field("In", inner, 1, {2})});
    const ValueShape made = shape({outer, 1, two});
    const Paths expected{
        "[0].X",          "[0].In[0].A",    "[0].In[0].B[0]", "[0].In[0].B[1]", "[0].In[1].A",
        "[0].In[1].B[0]", "[0].In[1].B[1]", "[1].X",          "[1].In[0].A",    "[1].In[0].B[0]",
        "[1].In[0].B[1]", "[1].In[1].A",    "[1].In[1].B[0]", "[1].In[1].B[1]",
    };
    CHECK(paths(made) == expected);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        CHECK(made.find_leaf(expected[i]) == i);
    }
    for (const auto* const none : {"", "[2].X", "[0]", "[0].Y", "[0].In.A", "[0].In[0].B[2]",
                                   "[0].X ", "[0].X[0]", "[-1].X", "[0", "[", "[0]."}) {
        CHECK(made.find_leaf(none) == std::nullopt);
    }
}

TEST_CASE_METHOD(ShapeFixture, "8.2 Limited assignment: of fields, element by element", "[8.2]")
{
    const NodeId inner = add_structure("Inner", {field("B", standard(id::Int32), 1)});
    CHECK(paths(shape({inner, 1, two})) == Paths{"[0].B[0]", "[1].B[0]"});
    const ValueShape made = shape({inner, 1, two}, {{"[1].B", 1, {3}}});
    CHECK(paths(made) == Paths{"[0].B[0]", "[1].B[0]", "[1].B[1]", "[1].B[2]"});
    CHECK(made.find_leaf("[1].B[2]") == 3U);
    CHECK(made.find_leaf("[0].B[2]") == std::nullopt);
    CHECK(leaves(made, counted(made).value()) == std::vector<std::int32_t>{1, 2, 3, 4});
    // A Method's Argument has none.
    const ValueShape argument = shape({inner, -1, {}, true});
    CHECK(argument.leaf_count() == 0);
    REQUIRE(argument.kept_fields().size() == 1);
    CHECK(number(argument.kept_fields()[0].error) == number(ShapeError::ArrayRank));
}

TEST_CASE_METHOD(ShapeFixture, "2.1 Structure hierarchies: 20 of them", "[2.1]")
{
    NodeId type = add_structure("S21", {field("M", standard(id::Int32))});
    for (int level = 20; level > 0; --level) {
        const std::string name = "S" + std::to_string(level);
        type = add_structure(name.c_str(), {field("M", standard(id::Int32)), field("S", type)});
    }
    const ValueShape made = shape({type});
    CHECK(made.leaf_count() == 20);
    REQUIRE(made.kept_fields().size() == 1);
    CHECK(number(made.kept_fields()[0].error) == number(ShapeError::Depth));
    ShapeLimits limits;
    limits.max_structure_depth = 21;
    CHECK(shape({type}, {}, limits).leaf_count() == 21);
}

TEST_CASE_METHOD(ShapeFixture, "8.2 Structure assignment: a structure of itself ends", "[8.2]")
{
    const NodeId list = own("List");
    add_structure("List", {field("A", standard(id::Int32)), field("L", list, 1, {2}),
                           field("R", list, 1, {2})});
    CHECK(error({list}) == number(ShapeError::TooManyLeaves));
    ShapeLimits limits;
    limits.max_structure_depth = 3;
    CHECK(shape({list}, {}, limits).leaf_count() == 1 + 4 + 16);
    constexpr std::array<std::uint32_t, 1> many{500'000};
    CHECK(error({list, 1, many}, limits) == number(ShapeError::TooManyLeaves));
}

TEST_CASE_METHOD(ShapeFixture, "2.1 Variable data size: words of each built-in type", "[2.1]")
{
    using B = BuiltInType;
    const std::array<std::pair<B, std::size_t>, 14> words{{
        {B::Boolean, 1},
        {B::SByte, 2},
        {B::Byte, 2},
        {B::Int16, 2},
        {B::UInt16, 2},
        {B::Int32, 2},
        {B::UInt32, 2},
        {B::Int64, 2},
        {B::UInt64, 2},
        {B::Float, 4},
        {B::Double, 4},
        {B::String, 256},
        {B::DateTime, 2},
        {B::Guid, 0},
    }};
    for (const auto& [type, expected] : words) {
        CAPTURE(name(type));
        CHECK(controller::words_of({type, false}) == expected);
    }
    const NodeId inner = add_structure("Inner", {field("A", standard(id::Boolean)),
                                                 field("B", standard(id::Double), 1, {3}),
                                                 field("Open", standard(id::Int32), 1)});
    CHECK(shape({inner}).words() == 1 + 3 * 4);
    CHECK(shape({inner, 1, two}).words() == 2 * (1 + 3 * 4));
    CHECK(shape({inner}, {{".Open", 1, {5}}}).words() == 1 + 3 * 4 + 5 * 2);
    CHECK(shape({standard(id::Int32), -2}).words() == 0);
}

TEST_CASE_METHOD(ShapeFixture, "8.1 CreateMonitoredItems: bytes of each built-in type", "[8.1]")
{
    constexpr std::array<std::size_t, last_built_in_type> expected{
        1, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8, 1024, 8, 1, 10'240, 1, 1, 1, 1, 1, 1024, 1, 1, 1, 1};
    for (std::size_t i = 0; i < expected.size(); ++i) {
        CHECK(controller::monitored_bytes_of(static_cast<BuiltInType>(i + 1)) == expected[i]);
    }
    CHECK(shape({standard(id::String), 2, two_by_three}).monitored_bytes() == 6 * 1024);
}

} // namespace value_shape_test

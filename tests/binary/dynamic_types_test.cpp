#include <catch2/catch.hpp>

#include "dynamic_fixture.hpp"

namespace dynamic_types_test {

using namespace busbar;
using namespace busbar::test;

namespace {

using Entries = std::vector<DataTypeEntry>;

/// The only error of `entries`, the first of which is the type that is wrong.
binary::DefinitionError error_of(Entries entries, const binary::DynamicTypeLimits& limits = {})
{
    const NodeId wrong = entries.front().id;
    const DynamicTypes compiled = DynamicTypes::compile(std::move(entries), limits);
    REQUIRE(compiled.errors().size() == 1);
    CHECK(compiled.errors()[0].type == wrong);
    CHECK(compiled.find(wrong) == nullptr);
    CHECK(compiled.find_encoding(encoding_of(wrong.numeric())) == nullptr);
    return compiled.errors()[0];
}

} // namespace

TEST_CASE("types may come in any order", "[binary][dynamic]")
{
    Entries entries = plant_types();
    for (std::size_t turn = 0; turn < entries.size(); ++turn) {
        std::rotate(entries.begin(), entries.begin() + 1, entries.end());
        const DynamicTypes compiled = DynamicTypes::compile(entries);
        REQUIRE(compiled.errors().empty());
        CHECK(compiled.size() == entries.size());
        CHECK(compiled.find_encoding(encoding_of(types::Part)) ==
              compiled.find(type_id(types::Part)));
    }
}

TEST_CASE("a field knows how it lies on the wire", "[binary][dynamic]")
{
    const DynamicType& part = *plant().find(type_id(types::Part));
    const auto& fields = part.fields;
    CHECK(fields[0].built_in == BuiltInType::String);
    CHECK(fields[1].built_in == BuiltInType::Double);
    CHECK(fields[2].built_in == BuiltInType::UInt16);
    CHECK(fields[2].type->kind == DynamicType::Kind::OptionSet);
    CHECK(fields[3].is_structure);
    CHECK(fields[3].type->kind == DynamicType::Kind::Union);
    CHECK(fields[5].is_matrix());
    CHECK(fields[8].built_in == BuiltInType::Variant);
    CHECK(fields[9].type->fields.size() == 2);
    // Name, Size, Flags, Shape's switch, two counts of structures, two of numbers, Variant, Bits
    CHECK(part.min_wire_size == 4 + 8 + 2 + 4 + 4 + 4 + 4 + 4 + 1 + 8);
    CHECK(part.find_field("Matrix") == 7U);
    CHECK_FALSE(part.find_field("matrix"));

    const DynamicType& container = *plant().find(type_id(types::Container));
    for (const std::size_t open : {0U, 1U, 3U}) {
        CHECK(container.fields[open].built_in == BuiltInType::ExtensionObject);
        CHECK_FALSE(container.fields[open].is_structure);
    }
    CHECK(container.fields[2].built_in == BuiltInType::Variant);
    CHECK_FALSE(container.has_optional_fields);

    const DynamicType& point3d = *plant().find(type_id(types::Point3D));
    const DynamicType& point = *plant().find(type_id(types::Point));
    CHECK(point3d.is_subtype_of(point));
    CHECK_FALSE(point.is_subtype_of(point3d));
}

TEST_CASE("a structure may contain itself only where an end is possible", "[binary][dynamic]")
{
    const NodeId self = type_id(1);
    CHECK(DynamicTypes::compile({structure(1, "A", Shape::Structure, {field("F", self, 1)})})
              .errors()
              .empty());
    CHECK(DynamicTypes::compile(
              {structure(1, "A", Shape::StructureWithOptionalFields, {field("F", self, -1, true)})})
              .errors()
              .empty());
    CHECK(DynamicTypes::compile({structure(1, "A", Shape::Union, {field("F", self)})})
              .errors()
              .empty());
    CHECK(DynamicTypes::compile(
              {structure(1, "A", Shape::StructureWithSubtypedValues, {field("F", self, -1, true)})})
              .errors()
              .empty());

    const auto direct = error_of({structure(1, "A", Shape::Structure, {field("F", self)})});
    CHECK(direct.status == status::Bad_NodeAttributesInvalid);
    CHECK(direct.field == "F");
    CHECK(to_string(direct) ==
          "ns=2;i=1 (A), field F: each value would contain another without end");

    const DynamicTypes circle = DynamicTypes::compile(
        {structure(1, "A", Shape::Structure, {field("B", type_id(2))}),
         structure(2, "B", Shape::Structure, {field("C", type_id(3))}),
         structure(3, "C", Shape::Structure, {field("N", id::Int32), field("A", type_id(1))}),
         structure(4, "D", Shape::Structure, {field("A", type_id(1))}),
         structure(5, "E", Shape::Structure, {field("N", id::Int32)})});
    CHECK(circle.errors().size() == 4);
    CHECK(circle.size() == 1);
    CHECK(circle.find(type_id(5)) != nullptr);
}

TEST_CASE("definitions that are wrong are refused by type and field", "[binary][dynamic]")
{
    const auto invalid = [](DataTypeEntry description, const char* field_name) {
        const auto error = error_of({std::move(description)});
        CHECK(error.status == status::Bad_NodeAttributesInvalid);
        CHECK(error.field == field_name);
        CHECK_FALSE(error.reason.empty());
    };
    for (const std::int32_t rank : {-4, -3, -2, 0, 17, INT32_MAX, INT32_MIN}) {
        INFO(rank);
        invalid(structure(1, "A", Shape::Structure, {field("F", id::Int32, rank)}), "F");
    }
    invalid(structure(1, "A", Shape::Structure, {field("F", id::Int32), field("F", id::Int32)}),
            "F");
    invalid(structure(1, "A", Shape::Structure, {field("", id::Int32)}), "");
    invalid(structure(1, "A", static_cast<Shape>(5), {}), "");
    invalid(structure(1, "A", static_cast<Shape>(-1), {}), "");
    invalid(enumeration(1, "A", NodeId{0, id::Enumeration}, {"Same", "Same"}), "Same");
    invalid(enumeration(1, "A", NodeId{0, id::String}, {"X"}), "");
    invalid(simple(1, "A", NodeId{0, id::Structure}), "");

    DataTypeEntry wrong = structure(1, "A", Shape::Union, {});
    wrong.base = NodeId{0, id::Structure};
    invalid(wrong, "");
    wrong.base = NodeId{0, id::Int32};
    invalid(wrong, "");
    DataTypeEntry dimensions = structure(1, "A", Shape::Structure, {field("F", id::Int32, 1)});
    std::get<StructureDefinition>(dimensions.definition).fields[0].array_dimensions = {2U, 3U};
    invalid(dimensions, "F");

    DataTypeEntry many = structure(1, "A", Shape::StructureWithOptionalFields, {});
    for (int i = 0; i < 33; ++i) {
        std::get<StructureDefinition>(many.definition)
            .fields.push_back(field(("F" + std::to_string(i)).c_str(), id::Byte, -1, true));
    }
    invalid(many, "");
    std::get<StructureDefinition>(many.definition).fields.pop_back();
    CHECK(DynamicTypes::compile({many}).errors().empty());
}

TEST_CASE("a type that is missing takes those along that need it", "[binary][dynamic]")
{
    const auto error = error_of({structure(1, "A", Shape::Structure, {field("F", type_id(99))})});
    CHECK(error.status == status::Bad_DataTypeIdUnknown);
    CHECK(error.field == "F");
    CHECK(error_of({simple(1, "A", type_id(99))}).status == status::Bad_DataTypeIdUnknown);

    const DynamicTypes compiled = DynamicTypes::compile(
        {structure(1, "A", Shape::Structure, {field("F", type_id(99))}),
         structure(2, "B", Shape::Structure, {field("A", type_id(1), 1)}),
         structure(3, "C", Shape::Union, {field("B", type_id(2))}),
         structure(4, "D", Shape::StructureWithSubtypedValues, {field("A", type_id(1), -1, true)}),
         simple(5, "E", type_id(98)), structure(6, "F", Shape::Structure, {field("E", type_id(5))}),
         structure(7, "G", Shape::Structure, {field("N", id::Int32)})});
    CHECK(compiled.errors().size() == 5);
    for (const std::uint32_t wrong : {1U, 2U, 3U, 5U, 6U}) {
        CHECK(compiled.find(type_id(wrong)) == nullptr);
    }
    CHECK(compiled.find(type_id(4)) != nullptr); // needs nothing of A to read an ExtensionObject
    CHECK(compiled.find(type_id(7)) != nullptr);
}

TEST_CASE("supertypes that go in circles are refused", "[binary][dynamic]")
{
    CHECK(error_of({simple(1, "A", type_id(1))}).status == status::Bad_NodeAttributesInvalid);
    const DynamicTypes circle = DynamicTypes::compile(
        {simple(1, "A", type_id(2)), simple(2, "B", type_id(1)), simple(3, "C", type_id(2))});
    CHECK(circle.errors().size() == 3);
    // Even the well-known types may be described so.
    DataTypeEntry number = simple(1, "A", NodeId{0, id::Structure}, true);
    DataTypeEntry root = simple(2, "Structure", type_id(1), true);
    root.id = NodeId{0, id::Structure};
    const DynamicTypes roots = DynamicTypes::compile(
        {number, root, structure(3, "C", Shape::Structure, {field("N", id::Int32)})});
    CHECK_FALSE(roots.find(type_id(1))->is_subtype_of(*roots.find(type_id(3))));
}

TEST_CASE("ids that are taken are refused", "[binary][dynamic]")
{
    const auto one = structure(1, "A", Shape::Structure, {field("N", id::Int32)});
    const DynamicTypes twice = DynamicTypes::compile({one, one});
    REQUIRE(twice.errors().size() == 1);
    CHECK(twice.size() == 1);
    DataTypeEntry null = one;
    null.id = NodeId{};
    CHECK(DynamicTypes::compile({null, one}).errors().size() == 1);

    auto other = structure(2, "B", Shape::Structure, {});
    std::get<StructureDefinition>(other.definition).default_encoding_id = encoding_of(1);
    const DynamicTypes shared = DynamicTypes::compile({one, other});
    CHECK(shared.errors().size() == 1);
    CHECK(shared.find_encoding(encoding_of(1)) == shared.find(type_id(1)));
}

TEST_CASE("definitions are held to their limits", "[binary][dynamic]")
{
    binary::DynamicTypeLimits limits;
    limits.max_fields = 2;
    limits.max_values = 2;
    const auto fields = {field("A", id::Byte), field("B", id::Byte), field("C", id::Byte)};
    const auto names = {"A", "B", "C"};
    CHECK(error_of({structure(1, "A", Shape::Structure, fields)}, limits).status ==
          status::Bad_EncodingLimitsExceeded);
    CHECK(error_of({enumeration(1, "A", NodeId{0, id::Enumeration}, names)}, limits).status ==
          status::Bad_EncodingLimitsExceeded);
    limits = {};
    limits.max_types = 2;
    CHECK(DynamicTypes::compile({simple(1, "A", NodeId{0, id::Byte}),
                                 simple(2, "B", NodeId{0, id::Byte}),
                                 simple(3, "C", NodeId{0, id::Byte})},
                                limits)
              .size() == 2);
}

TEST_CASE("structures that double in each other are refused", "[binary][dynamic]")
{
    Entries doubling{structure(1, "A", Shape::Structure, {})};
    for (std::uint32_t i = 2; i <= 40; ++i) {
        doubling.push_back(structure(i, "A", Shape::Structure,
                                     {field("L", type_id(i - 1)), field("R", type_id(i - 1))}));
    }
    const DynamicTypes compiled = DynamicTypes::compile(doubling);
    CHECK(compiled.find(type_id(12)) != nullptr);
    CHECK(compiled.find(type_id(14)) == nullptr);
    CHECK(compiled.find(type_id(40)) == nullptr);
    CHECK(compiled.errors()[0].status == status::Bad_EncodingLimitsExceeded);

    Entries deep{structure(1, "A", Shape::Structure, {})};
    for (std::uint32_t i = 2; i <= 20'000; ++i) {
        deep.push_back(structure(i, "A", Shape::Structure, {field("F", type_id(i - 1))}));
    }
    const DynamicTypes chain = DynamicTypes::compile(deep);
    CHECK(chain.size() == 100);
}

} // namespace dynamic_types_test

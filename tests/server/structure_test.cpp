#include <catch2/catch.hpp>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/model/data_types.hpp>

#include "attribute_fixture.hpp"

namespace structure_test {

using namespace busbar;
using busbar::test::AttributeFixture;

namespace {

/// Variables of types that are known from their DataTypeDefinitions only.
struct StructureFixture : AttributeFixture {
    StructureFixture()
    {
        using enum StructureDefinitionType;
        add_type("Point", id::Structure, Structure, {field("X", NodeId{0, id::Double})});
        add_type("Wide", type("Point"), Structure,
                 {field("X", NodeId{0, id::Double}), field("Name", NodeId{0, id::String})});
        add_type("Other", id::Structure, Structure, {field("N", NodeId{0, id::Int32})});
        add_type("Box", id::Structure, StructureWithSubtypedValues,
                 {field("Place", type("Point"), true)});
        scalar = add_variable("Scalar", "Point", make("Point"), -1);
        array = add_variable("Array", "Point",
                             Array<ExtensionObject>{object(1), object(2), object(3)}, 1);
    }

    static StructureField field(const char* name, NodeId type, bool is_optional = false)
    {
        StructureField result;
        result.name = name;
        result.data_type = std::move(type);
        result.value_rank = -1;
        result.is_optional = is_optional;
        return result;
    }
    [[nodiscard]] NodeId type(const char* name) const { return NodeId{namespace_index, name}; }
    void add_type(const char* name, const NodeId& base, StructureDefinitionType kind,
                  std::initializer_list<StructureField> fields)
    {
        StructureDefinition definition;
        definition.structure_type = kind;
        definition.fields = fields;
        model::NewNode node;
        node.id = type(name);
        node.browse_name = QualifiedName{namespace_index, name};
        node.parent = space.find(base);
        REQUIRE(model::add_structure_type(space, node, definition));
    }
    void add_type(const char* name, std::uint32_t base, StructureDefinitionType kind,
                  std::initializer_list<StructureField> fields)
    {
        add_type(name, NodeId{0, base}, kind, fields);
    }
    NodeId add_variable(const char* name, const char* data_type, Variant value, std::int32_t rank)
    {
        model::NewVariable variable;
        variable.data_type = type(data_type);
        variable.value_rank = rank;
        variable.access_level = model::Access::ReadWrite;
        variable.value = std::move(value);
        return add(name, variable);
    }
    [[nodiscard]] binary::DynamicValue value(const char* name)
    {
        return binary::DynamicValue{*data_types.of(space).find(type(name))};
    }
    [[nodiscard]] ExtensionObject object(const binary::DynamicValue& from)
    {
        return binary::to_extension_object(from).value();
    }
    [[nodiscard]] ExtensionObject object(double x)
    {
        auto point = value("Point");
        REQUIRE(point.set("X", Variant{x}));
        return object(point);
    }
    [[nodiscard]] Variant make(const char* name) { return Variant{object(value(name))}; }
    /// A value of a type with bytes of the test's own.
    [[nodiscard]] Variant forged(const char* name, std::size_t size)
    {
        const std::vector<std::byte> body(size);
        return Variant{ExtensionObject::from_binary(
            data_types.of(space).find(type(name))->encoding_id, ByteString{std::span{body}})};
    }

    NodeId scalar;
    NodeId array;
};

} // namespace

TEST_CASE_METHOD(StructureFixture, "structures are written if they are of the Variable's type",
                 "[unit:Attribute Read Complex][unit:Attribute Write Complex]")
{
    CHECK(write(scalar, Variant{object(7)}) == status::Good);
    CHECK(read(scalar).value == Variant{object(7)});
    CHECK(write(scalar, make("Wide")) == status::Good); // a subtype
    CHECK(write(scalar, make("Other")) == status::Bad_TypeMismatch);
    CHECK(write(scalar, Variant{ExtensionObject::from_binary(NodeId{namespace_index, "No"}, {})}) ==
          status::Bad_TypeMismatch);
    CHECK(write(scalar, Variant{1.0}) == status::Bad_TypeMismatch);
    CHECK(write(scalar, Variant{Array<ExtensionObject>{object(1)}}) == status::Bad_TypeMismatch);
    CHECK(read(scalar).value == make("Wide"));
}

TEST_CASE_METHOD(StructureFixture, "a body that its definition does not describe is refused")
{
    CHECK(write(scalar, forged("Point", 8)) == status::Good);
    for (const std::size_t size : {0U, 7U, 9U, 100U}) {
        CHECK(write(scalar, forged("Point", size)) == status::Bad_DecodingError);
    }
    const NodeId encoding = data_types.of(space).find(type("Point"))->encoding_id;
    CHECK(write(scalar, Variant{ExtensionObject::from_id(encoding)}) == status::Bad_DecodingError);
    CHECK(write(scalar, Variant{ExtensionObject::from_xml(encoding, XmlElement{"<X/>"})}) ==
          status::Bad_DecodingError);
    const Variant bad = forged("Point", 3);
    CHECK(
        write(array, Variant{Array<ExtensionObject>{object(1), *bad.get_if<ExtensionObject>()}}) ==
        status::Bad_DecodingError);
    CHECK(read(array).value.array_size() == 3);
}

TEST_CASE_METHOD(StructureFixture, "texts and arrays in structures have their limits")
{
    StructureField name = field("Name", NodeId{0, id::String});
    name.max_string_length = 4;
    StructureField numbers = field("Numbers", NodeId{0, id::Int32});
    numbers.value_rank = 1;
    numbers.array_dimensions = {2};
    add_type("Short", id::Structure, StructureDefinitionType::Structure, {name, numbers});
    const NodeId variable = add_variable("Short1", "Short", make("Short"), -1);
    auto content = value("Short");
    REQUIRE(content.set("Name", Variant{"abcd"}));
    REQUIRE(content.set("Numbers", Variant{Array<std::int32_t>{1, 2}}));
    CHECK(write(variable, Variant{object(content)}) == status::Good);
    const Variant kept = read(variable).value;
    REQUIRE(content.set("Name", Variant{"abcde"}));
    CHECK(write(variable, Variant{object(content)}) == status::Bad_OutOfRange);
    REQUIRE(content.set("Name", Variant{""}));
    REQUIRE(content.set("Numbers", Variant{Array<std::int32_t>{1, 2, 3}}));
    CHECK(write(variable, Variant{object(content)}) == status::Bad_OutOfRange);
    CHECK(read(variable).value == kept);
}

TEST_CASE_METHOD(StructureFixture, "what a structure holds encoded is looked at, too")
{
    const NodeId box = add_variable("Box1", "Box", make("Box"), -1);
    auto content = value("Box");
    REQUIRE(content.set("Place", value("Wide")));
    CHECK(write(box, Variant{object(content)}) == status::Good);
    REQUIRE(content.set("Place", Variant{object(value("Other"))}));
    CHECK(write(box, Variant{object(content)}) == status::Bad_TypeMismatch);
    REQUIRE(content.set("Place", forged("Point", 9)));
    CHECK(write(box, Variant{object(content)}) == status::Bad_DecodingError);

    // Boxes in boxes cost a client few bytes each, so there is an end to looking.
    const auto boxes = [&](int levels) {
        auto outer = value("Open");
        for (int i = 1; i < levels; ++i) {
            auto next = value("Open");
            REQUIRE(next.set("Any", std::move(outer)));
            outer = std::move(next);
        }
        return binary::check_dynamic(Variant{object(outer)}, data_types.of(space));
    };
    add_type("Open", id::Structure, StructureDefinitionType::Structure,
             {field("Any", NodeId{0, id::Structure})});
    CHECK(boxes(100) == status::Good);
    CHECK(boxes(200) == status::Bad_EncodingLimitsExceeded);
}

TEST_CASE_METHOD(StructureFixture, "a range of an array of structures is read and written")
{
    CHECK(read(array, AttributeId::Value, "1:2").value ==
          Variant{Array<ExtensionObject>{object(2), object(3)}});
    CHECK(read(array, AttributeId::Value, "3").status == status::Bad_IndexRangeNoData);
    CHECK(read(scalar, AttributeId::Value, "0").status == status::Bad_IndexRangeNoData);

    CHECK(write(array, Variant{Array<ExtensionObject>{object(8)}}, "1") == status::Good);
    CHECK(read(array).value == Variant{Array<ExtensionObject>{object(1), object(8), object(3)}});
    CHECK(write(array, Variant{Array<ExtensionObject>{object(8)}}, "1:2") ==
          status::Bad_IndexRangeDataMismatch);
    CHECK(write(array, Variant{Array<ExtensionObject>{object(8)}}, "3") ==
          status::Bad_IndexRangeNoData);
    CHECK(write(array, Variant{Array<ExtensionObject>{object(value("Other"))}}, "1") ==
          status::Bad_TypeMismatch);
    const Variant bad = forged("Point", 3);
    CHECK(write(array, Variant{Array<ExtensionObject>{*bad.get_if<ExtensionObject>()}}, "1") ==
          status::Bad_DecodingError);
}

TEST_CASE_METHOD(StructureFixture, "ranges written to a source hold its type of structure")
{
    model::NewVariable variable;
    variable.data_type = type("Point");
    variable.value_rank = 1;
    variable.access_level = model::Access::ReadWrite;
    variable.source = 0;
    variable.handle = memory.add(Variant{Array<ExtensionObject>{object(1), object(2)}});
    const NodeId far = add("Far", variable);
    CHECK(write(far, Variant{Array<ExtensionObject>{object(value("Other"))}}, "1") ==
          status::Bad_TypeMismatch);
    CHECK(write(far, Variant{Array<ExtensionObject>{object(9)}}, "1") == status::Good);
    CHECK(read(far).value == Variant{Array<ExtensionObject>{object(1), object(9)}});
}

TEST_CASE_METHOD(StructureFixture, "types have their definitions and encodings",
                 "[unit:Address Space DataTypeDefinition Attribute]")
{
    const auto definition = read(type("Box"), AttributeId::DataTypeDefinition).value;
    REQUIRE(definition.type() == BuiltInType::ExtensionObject);
    CHECK(definition.get_if<ExtensionObject>()->encoding_id() ==
          NodeId{0, StructureDefinition::binary_encoding_id});
    CHECK(read(NodeId{0, id::Structure}, AttributeId::DataTypeDefinition).status ==
          status::Bad_AttributeIdInvalid);
    CHECK(read(NodeId{0, id::ServerState}, AttributeId::DataTypeDefinition).status == status::Good);

    ReadValueId value_id = read_value_id(scalar);
    const auto read_as = [&](QualifiedName encoding) {
        value_id.data_encoding = std::move(encoding);
        return read(read_request({value_id}))[0].status;
    };
    CHECK(read_as(QualifiedName{}) == status::Good);
    CHECK(read_as(QualifiedName{0, "Default Binary"}) == status::Good);
    for (const char* const other : {"Default XML", "Default JSON", "Mine"}) {
        CHECK(read_as(QualifiedName{0, other}) == status::Bad_DataEncodingUnsupported);
    }
    value_id.node_id = type("Point");
    value_id.attribute_id = static_cast<std::uint32_t>(AttributeId::DataTypeDefinition);
    CHECK(read_as(QualifiedName{0, "Default Binary"}) == status::Bad_DataEncodingInvalid);
}

} // namespace structure_test

#include <catch2/catch.hpp>

#include <busbar/types/types.hpp>

#include "model_fixture.hpp"

namespace busbar::model::type_test {

TEST_CASE_METHOD(ModelFixture, "Subtypes are known of constant and of dynamic types")
{
    const NodeIndex base = space.find(id::BaseObjectType);
    const NodeIndex folder = space.find(id::FolderType);
    CHECK(space.is_subtype_of(base, base));
    CHECK(space.is_subtype_of(folder, base));
    CHECK_FALSE(space.is_subtype_of(base, folder));
    CHECK_FALSE(space.is_subtype_of(objects, base));
    CHECK_FALSE(space.is_subtype_of(no_node, base));
    CHECK_FALSE(space.is_subtype_of(base, no_node));

    const NodeIndex motor = space.add_object_type(named("Motor", base), true).value();
    const NodeIndex servo = space.add_object_type(named("Servo", motor)).value();
    const NodeIndex pump = space.add_object_type(named("Pump", base)).value();
    CHECK(space.is_subtype_of(servo, motor));
    CHECK(space.is_subtype_of(servo, base));
    CHECK(space.is_subtype_of(servo, servo));
    CHECK_FALSE(space.is_subtype_of(motor, servo));
    CHECK_FALSE(space.is_subtype_of(pump, motor));
    CHECK_FALSE(space.is_subtype_of(servo, folder));
    CHECK_FALSE(space.is_subtype_of(folder, servo));
    CHECK(space.supertype(servo) == motor);
    CHECK(space.supertype(folder) == base);
    CHECK(space.is_abstract(motor));

    NewObject object;
    object.type_definition = NodeId{ns, "Motor"};
    CHECK(status_of(space.add_object(named("m", objects), object)) ==
          status::Bad_TypeDefinitionInvalid);
    object.type_definition = NodeId{ns, "Servo"};
    CHECK(space.add_object(named("m", objects), object));
    CHECK(status_of(space.add_object_type(named("x", objects))) == status::Bad_ReferenceNotAllowed);
    CHECK(status_of(space.remove(pump)) == status::Bad_NoDeleteRights);
}

TEST_CASE_METHOD(ModelFixture, "ReferenceTypes can be added")
{
    NewReferenceType type;
    type.inverse_name = LocalizedText{"DrivenBy"};
    const NodeIndex drives =
        space.add_reference_type(named("Drives", space.find(id::HasComponent)), type).value();
    CHECK(space.is_subtype_of(drives, id::HierarchicalReferences));
    NewNode node = named("child", add_folder("folder", objects));
    node.reference_type = NodeId{ns, "Drives"};
    const NodeIndex child = space.add_folder(node).value();
    CHECK(space.references(child).next()->type == drives);
    CHECK(space.attribute(drives, AttributeId::InverseName).value() ==
          Variant{LocalizedText{"DrivenBy"}});
    CHECK(space.attribute(drives, AttributeId::Symmetric).value() == Variant{false});
}

TEST_CASE_METHOD(ModelFixture, "The built-in type of a DataType is that of its supertypes")
{
    const auto built_in = [&](std::uint32_t type) {
        return space.built_in_type_of(space.find(type));
    };
    CHECK(built_in(id::Int32) == BuiltInType::Int32);
    CHECK(built_in(id::UtcTime) == BuiltInType::DateTime);
    CHECK(built_in(id::ServerState) == BuiltInType::Int32);
    CHECK(built_in(id::Argument) == BuiltInType::ExtensionObject);
    CHECK(built_in(id::Number) == BuiltInType::Variant);
    CHECK(built_in(id::BaseDataType) == BuiltInType::Variant);
    CHECK(built_in(id::BaseObjectType) == BuiltInType::Null);
    CHECK(space.built_in_type_of(no_node) == BuiltInType::Null);

    const NodeIndex mine = space.add_data_type(named("Rpm", space.find(id::Double)), {}).value();
    CHECK(space.built_in_type_of(mine) == BuiltInType::Double);
    CHECK(space.check_value(Variant{1.0}, mine, -1, {}) == status::Good);
}

TEST_CASE_METHOD(ModelFixture, "Values are checked against DataType, ValueRank and ArrayDimensions")
{
    const auto check = [&](const Variant& value, std::uint32_t type, std::int32_t rank,
                           std::initializer_list<std::uint32_t> dimensions = {}) {
        const Array<std::uint32_t> limits(dimensions);
        return space.check_value(value, space.find(type), rank, limits.span()) == status::Good;
    };
    const Variant array{Array<std::int32_t>{1, 2, 3}};
    const Variant matrix = Variant::matrix(Array<std::int32_t>{1, 2, 3, 4}, {2U, 2U});

    CHECK(check(Variant{1}, id::Int32, -1));
    CHECK_FALSE(check(Variant{1U}, id::Int32, -1));
    CHECK_FALSE(check(Variant{}, id::Int32, -1));
    CHECK(check(Variant{}, id::BaseDataType, -1));
    CHECK(check(Variant{"x"}, id::BaseDataType, -2));

    CHECK(check(Variant{1U}, id::Number, -1));
    CHECK(check(Variant{1.5}, id::Number, -1));
    CHECK_FALSE(check(Variant{"x"}, id::Number, -1));
    CHECK(check(Variant{1U}, id::UInteger, -1));
    CHECK_FALSE(check(Variant{1}, id::UInteger, -1));
    CHECK(check(Variant{1}, id::Integer, -1));
    CHECK_FALSE(check(Variant{1.5}, id::Integer, -1));
    CHECK(check(Variant{2}, id::ServerState, -1));

    CHECK_FALSE(check(array, id::Int32, -1));
    CHECK(check(array, id::Int32, 1));
    CHECK(check(array, id::Int32, 0));
    CHECK(check(array, id::Int32, -3));
    CHECK_FALSE(check(matrix, id::Int32, -3));
    CHECK(check(matrix, id::Int32, 2));
    CHECK_FALSE(check(matrix, id::Int32, 1));
    CHECK_FALSE(check(Variant{1}, id::Int32, 1));
    CHECK_FALSE(check(Variant{1}, id::Int32, 0));

    CHECK(check(array, id::Int32, 1, {3}));
    CHECK(check(array, id::Int32, 1, {0}));
    CHECK_FALSE(check(array, id::Int32, 1, {2}));
    CHECK(check(matrix, id::Int32, 2, {2, 0}));
    CHECK_FALSE(check(matrix, id::Int32, 2, {1, 2}));

    const std::byte bytes[2]{};
    const Variant byte_string{ByteString{std::span{bytes}}};
    CHECK(check(byte_string, id::Byte, 1));
    CHECK(check(byte_string, id::Byte, 1, {2}));
    CHECK_FALSE(check(byte_string, id::Byte, 1, {1}));
    CHECK_FALSE(check(byte_string, id::Byte, -1));
    CHECK(check(byte_string, id::ByteString, -1));

    const Variant argument{ExtensionObject::from(Argument{})};
    CHECK(check(argument, id::Argument, -1));
    CHECK(check(argument, id::Structure, -1));
    CHECK_FALSE(check(argument, id::BuildInfo, -1));
    CHECK_FALSE(check(Variant{ExtensionObject::from_id(NodeId{ns, 5U})}, id::Argument, -1));
    CHECK(check(Variant{ExtensionObject{}}, id::Argument, -1));
}

} // namespace busbar::model::type_test

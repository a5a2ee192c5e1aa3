#include <catch2/catch.hpp>

#include <busbar/binary/codec.hpp>
#include <busbar/types/registry.hpp>
#include <busbar/types/types.hpp>

#include "model_fixture.hpp"

namespace busbar::model::namespace0_test {

namespace {

bool has_reference(const AddressSpace& space, NodeIndex from, const Reference& sought)
{
    ReferenceCursor cursor = space.references(from);
    while (const auto reference = cursor.next()) {
        if (reference->type == sought.type && reference->target == sought.target &&
            reference->is_forward == sought.is_forward) {
            return true;
        }
    }
    return false;
}

} // namespace

TEST_CASE("Every constant node is whole", "[unit:Address Space Base][unit:Base Info Type System]"
                                          "[unit:Base Info Type Information]")
{
    const AddressSpace space;
    const NodeIndex has_type = space.find(id::HasTypeDefinition);
    const NodeIndex has_rule = space.find(id::HasModellingRule);
    std::size_t count = 0;
    space.for_each([&](NodeIndex node) {
        ++count;
        const NodeId node_id = space.node_id(node);
        INFO(to_string(node_id));
        REQUIRE(space.find(node_id) == node);
        REQUIRE_FALSE(space.browse_name(node).name.empty());
        REQUIRE_FALSE(space.display_name(node).text.empty());
        const NodeClass node_class = space.node_class(node);
        for (std::uint32_t i = 1; i <= 27; ++i) {
            const auto id = AttributeId{i};
            const bool may_be = AddressSpace::has_attribute(node_class, id);
            const auto value = space.attribute(node, id);
            REQUIRE((may_be || !value));
            REQUIRE((value || value.error() == status::Bad_AttributeIdInvalid));
        }
        if (node_class == NodeClass::Object || node_class == NodeClass::Variable) {
            REQUIRE(space.type_definition(node) != no_node);
        } else if (node_class != NodeClass::Method && node_class != NodeClass::View) {
            const bool is_root = node_id.is(id::BaseObjectType) ||
                                 node_id.is(id::BaseVariableType) || node_id.is(id::BaseDataType) ||
                                 node_id.is(id::References);
            REQUIRE(is_root == (space.supertype(node) == no_node));
        }
        ReferenceCursor cursor = space.references(node);
        while (const auto reference = cursor.next()) {
            REQUIRE(space.node_class(reference->type) == NodeClass::ReferenceType);
            if (reference->type != has_type && reference->type != has_rule) {
                REQUIRE(has_reference(space, reference->target,
                                      {reference->type, node, !reference->is_forward}));
            }
        }
    });
    CHECK(count == space.node_count());
}

TEST_CASE("Every value and definition of namespace 0 decodes and fits its Variable")
{
    const AddressSpace space;
    const binary::TypeRegistry types{binary::namespace0_types()};
    space.for_each([&](NodeIndex node) {
        INFO(to_string(space.node_id(node)));
        const Variant value = space.value(node, &types);
        if (!value.is_null()) {
            const VariableAttributes attributes = space.variable(node);
            REQUIRE(space.check_value(value, attributes.data_type, attributes.value_rank,
                                      attributes.array_dimensions) == status::Good);
            if (const auto* const objects = value.array_if<ExtensionObject>()) {
                for (const ExtensionObject& object : *objects) {
                    REQUIRE(object.body() == ExtensionObject::Body::Object);
                }
            }
        }
        const auto definition = space.attribute(node, AttributeId::DataTypeDefinition);
        if (definition) {
            REQUIRE(definition->get_if<ExtensionObject>() != nullptr);
        }
    });
}

TEST_CASE("The types' tree is the one that HasSubtype spans")
{
    const AddressSpace space;
    space.for_each([&](NodeIndex node) {
        for (NodeIndex above = node; above != no_node; above = space.supertype(above)) {
            REQUIRE((space.is_subtype_of(node, above) ||
                     space.node_class(node) < NodeClass::ObjectType ||
                     space.node_class(node) == NodeClass::View));
        }
    });
    CHECK(space.is_subtype_of(space.find(id::HasProperty), id::Aggregates));
    CHECK_FALSE(space.is_subtype_of(space.find(id::HasProperty), id::Organizes));
    CHECK_FALSE(space.is_subtype_of(space.find(id::References), id::Organizes));
}

TEST_CASE("Well-known nodes of namespace 0 have the attributes of Part 5")
{
    const AddressSpace space;
    const NodeIndex server = space.find(id::Server);
    REQUIRE(server != no_node);
    CHECK(space.node_class(server) == NodeClass::Object);
    CHECK(space.type_definition(server) == space.find(id::ServerType));
    const NodeIndex has_component = space.find(id::HasComponent);
    CHECK(space.attribute(has_component, AttributeId::InverseName).value() ==
          Variant{LocalizedText{"ComponentOf"}});
    CHECK(space.attribute(space.find(id::References), AttributeId::IsAbstract).value() ==
          Variant{true});
    const NodeIndex start_time = space.find(id::Server_ServerStatus_StartTime);
    REQUIRE(start_time != no_node);
    CHECK(space.data_type_id(start_time).is(id::UtcTime));
    CHECK(space.variable(start_time).access_level == 1);
    CHECK(space.value(start_time).is_null());
}

TEST_CASE("InputArguments and DataTypeDefinitions are those of the specification")
{
    const AddressSpace space;
    if (!is_full(space)) {
        return;
    }
    const binary::TypeRegistry types{binary::namespace0_types()};
    const Variant value =
        space.value(space.find(id::Server_GetMonitoredItems_InputArguments), &types);
    const auto* const objects = value.array_if<ExtensionObject>();
    REQUIRE(objects != nullptr);
    REQUIRE(objects->size() == 1);
    const auto* const argument = (*objects)[0].get_if<Argument>();
    REQUIRE(argument != nullptr);
    CHECK(argument->name == "SubscriptionId");
    CHECK(argument->data_type == NodeId{0, id::UInt32});
    CHECK(argument->value_rank == -1);

    const auto definition = [&](std::uint32_t type) {
        const auto encoded = space.attribute(space.find(type), AttributeId::DataTypeDefinition);
        REQUIRE(encoded);
        const auto bytes = binary::to_bytes(*encoded).value();
        return binary::from_bytes<Variant>(bytes, &types).value();
    };
    const Variant range = definition(id::Range);
    const auto* const structure = range.get_if<ExtensionObject>()->get_if<StructureDefinition>();
    REQUIRE(structure != nullptr);
    CHECK(structure->default_encoding_id == NodeId{0, id::encoding::Range});
    CHECK(structure->base_data_type == NodeId{0, id::Structure});
    REQUIRE(structure->fields.size() == 2);
    CHECK(structure->fields[0].name == "Low");
    CHECK(structure->fields[0].data_type == NodeId{0, id::Double});

    const Variant state = definition(id::ServerState);
    const auto* const enumeration = state.get_if<ExtensionObject>()->get_if<EnumDefinition>();
    REQUIRE(enumeration != nullptr);
    REQUIRE(enumeration->fields.size() == 8);
    CHECK(enumeration->fields[7].value == 7);
    CHECK(enumeration->fields[7].name == "Unknown");

    // The fields of the supertype come first (Part 3, 8.48).
    const Variant policy = definition(id::AnonymousIdentityToken);
    const auto* const token = policy.get_if<ExtensionObject>()->get_if<StructureDefinition>();
    REQUIRE(token->fields.size() == 1);
    CHECK(token->fields[0].name == "PolicyId");
}

} // namespace busbar::model::namespace0_test

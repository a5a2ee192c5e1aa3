#include "namespace_nodes.hpp"

#include <array>
#include <span>

#include <busbar/types/ids.hpp>

namespace busbar::server::detail {

namespace {

using model::NodeIndex;

Variant id_types(const NamespaceMetadata& from)
{
    Array<std::int32_t> types;
    for (const IdType type : from.static_node_id_types) {
        types.push_back(static_cast<std::int32_t>(type));
    }
    return types;
}

Variant numeric_ranges(const NamespaceMetadata& from)
{
    Array<String> ranges;
    for (const std::string& range : from.static_numeric_ranges) {
        ranges.emplace_back(range);
    }
    return ranges;
}

struct Property {
    const char* name;
    std::uint32_t data_type;
    std::int32_t value_rank;
    Variant (*value)(const NamespaceMetadata& from);
};

/// The mandatory ones except NamespaceUri.
constexpr std::array properties{
    Property{"NamespaceVersion", id::String, -1,
             [](const NamespaceMetadata& from) -> Variant { return String{from.version}; }},
    Property{"NamespacePublicationDate", id::DateTime, -1,
             [](const NamespaceMetadata& from) -> Variant { return from.publication_date; }},
    Property{"IsNamespaceSubset", id::Boolean, -1,
             [](const NamespaceMetadata& from) -> Variant { return from.is_subset; }},
    Property{"StaticNodeIdTypes", id::IdType, 1, id_types},
    Property{"StaticNumericNodeIdRange", id::NumericRange, 1, numeric_ranges},
    Property{"StaticStringNodeIdPattern", id::String, -1,
             [](const NamespaceMetadata& from) -> Variant {
                 return String{from.static_string_pattern};
             }},
};

/// Its BrowseName is the URI (Part 5, 6.3.13), qualified with any namespace.
NodeIndex find_namespace(const model::AddressSpace& space, NodeIndex parent, std::string_view uri)
{
    model::ReferenceCursor cursor = space.references(parent);
    while (const auto reference = cursor.next()) {
        if (reference->is_forward &&
            space.is_subtype_of(reference->type, id::HierarchicalReferences) &&
            space.browse_name(reference->target).name.view() == uri) {
            return reference->target;
        }
    }
    return model::no_node;
}

StatusCode add_property(model::AddressSpace& space, NodeIndex object, const Property& property,
                        Variant value)
{
    const NodeId of_object = space.node_id(object);
    model::NewNode node;
    node.id = NodeId{of_object.namespace_index(),
                     String{std::string{of_object.string().view()} + "." + property.name}};
    node.browse_name = QualifiedName{0, property.name};
    node.parent = object;
    model::NewVariable variable;
    variable.data_type = NodeId{0, property.data_type};
    variable.value_rank = property.value_rank;
    variable.value = std::move(value);
    const auto added = space.add_property(node, std::move(variable));
    return added ? status::Good : added.error();
}

StatusCode add_properties(model::AddressSpace& space, NodeIndex object, std::string_view uri)
{
    constexpr Property namespace_uri{"NamespaceUri", id::String, -1, nullptr};
    StatusCode status = add_property(space, object, namespace_uri, String{uri});
    for (const Property& property : properties) {
        if (status.is_bad()) {
            break;
        }
        status = add_property(space, object, property, property.value({}));
    }
    return status;
}

} // namespace

Result<NodeIndex> find_or_add_namespace(model::AddressSpace& space, std::uint16_t own_namespace,
                                        std::uint16_t index)
{
    if (index >= space.namespace_count()) {
        return fail(status::Bad_NotFound);
    }
    const std::string uri{space.namespace_uri(index)};
    model::NewNode node;
    node.parent = space.find(id::Server_Namespaces);
    if (node.parent == model::no_node || space.find(id::NamespaceMetadataType) == model::no_node) {
        return fail(status::Bad_NotSupported);
    }
    const NodeIndex found = find_namespace(space, node.parent, uri);
    if (found != model::no_node) {
        return found;
    }
    node.id = NodeId{own_namespace, String{"Server.Namespaces." + uri}};
    node.browse_name = QualifiedName{index, String{uri}};
    const auto object = space.add_object(node, {NodeId{0, id::NamespaceMetadataType}, 0});
    if (!object) {
        return object;
    }
    if (const StatusCode bad = add_properties(space, *object, uri); bad.is_bad()) {
        static_cast<void>(space.remove(*object));
        return fail(bad);
    }
    return object;
}

namespace {

void set_properties(model::AddressSpace& space, NodeIndex object, std::span<const Property> some,
                    const NamespaceMetadata& metadata)
{
    for (const Property& property : some) {
        static_cast<void>(space.for_each_child(
            object, space.find(id::HasProperty), true, QualifiedName{0, property.name},
            [&](NodeIndex child) {
                static_cast<void>(space.set_value(child, property.value(metadata)));
                return false;
            }));
    }
}

} // namespace

void set_metadata(model::AddressSpace& space, NodeIndex object, const NamespaceMetadata& metadata)
{
    set_properties(space, object, properties, metadata);
}

void set_version(model::AddressSpace& space, NodeIndex object, const NamespaceMetadata& metadata)
{
    constexpr std::size_t version_and_date = 2;
    set_properties(space, object, std::span{properties}.first(version_and_date), metadata);
}

namespace {

/// Returns the property's node, which is added if it is missing.
NodeIndex find_or_add_property(model::AddressSpace& space, NodeIndex object,
                               const Property& property)
{
    NodeIndex found = model::no_node;
    const auto find = [&] {
        space.for_each_child(object, space.find(id::HasProperty), true,
                             QualifiedName{0, property.name}, [&](NodeIndex child) {
                                 found = child;
                                 return false;
                             });
    };
    find();
    if (found == model::no_node && !add_property(space, object, property, {}).is_bad()) {
        find();
    }
    return found;
}

void show_permissions(model::AddressSpace& space, NodeIndex object,
                      const Array<RolePermissionType>& permissions)
{
    constexpr Property property{"DefaultRolePermissions", id::RolePermissionType, 1, nullptr};
    const NodeIndex node = find_or_add_property(space, object, property);
    if (node == model::no_node) {
        return;
    }
    constexpr auto browse_and_read =
        PermissionType{static_cast<std::uint32_t>(PermissionType::Browse) |
                       static_cast<std::uint32_t>(PermissionType::Read)};
    model::NodeAccess access;
    for (const std::uint32_t role :
         {id::WellKnownRole_ConfigureAdmin, id::WellKnownRole_SecurityAdmin}) {
        access.role_permissions.push_back({NodeId{0, role}, browse_and_read});
    }
    space.set_node_access(node, std::move(access));
    Array<ExtensionObject> shown;
    shown.clear(); // not null
    for (const RolePermissionType& each : permissions) {
        shown.push_back(ExtensionObject::from(each));
    }
    static_cast<void>(space.set_value(node, Variant{std::move(shown)}));
}

} // namespace

void show_defaults(model::AddressSpace& space, NodeIndex object, std::uint16_t index)
{
    if (const auto permissions = space.namespace_permissions(index); !permissions.is_null()) {
        show_permissions(space, object, permissions);
    }
    if (const std::uint16_t restrictions = space.namespace_restrictions(index); restrictions != 0) {
        constexpr Property property{"DefaultAccessRestrictions", id::AccessRestrictionType, -1,
                                    nullptr};
        const NodeIndex node = find_or_add_property(space, object, property);
        if (node != model::no_node) {
            static_cast<void>(space.set_value(node, Variant{restrictions}));
        }
    }
}

} // namespace busbar::server::detail

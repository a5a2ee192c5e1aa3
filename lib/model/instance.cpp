#include <busbar/model/instance.hpp>

#include <algorithm>

#include <busbar/binary/codec.hpp>
#include <busbar/types/ids.hpp>

#include "instantiation.hpp"

namespace busbar::model {

namespace {

/// Returns the BrowseName for instances of an AddIn's type.
Result<QualifiedName> default_name_of(const SpaceReader& space, NodeIndex type)
{
    const QualifiedName property{0, "DefaultInstanceBrowseName"};
    for (NodeIndex at = type; at != no_node; at = space.supertype(at)) {
        const NodeIndex found = detail::child_of(space, at, property);
        if (found == no_node) {
            continue;
        }
        const Variant value = space.value(found);
        if (const auto* const name = value.get_if<QualifiedName>()) {
            return *name;
        }
    }
    return fail(status::Bad_BrowseNameInvalid);
}

} // namespace

std::size_t memory_of(const SpaceReader& space, NodeIndex node)
{
    constexpr std::size_t record_and_slots = 256;
    // A decoded value exceeds its encoding by no more than the headers of its fields.
    constexpr std::size_t bytes_per_encoded_byte = 8;
    binary::CountingSink sink;
    binary::Writer writer{sink};
    encode(writer, space.node_id(node));
    encode(writer, space.browse_name(node));
    encode(writer, space.display_name(node));
    encode(writer, space.attribute(node, AttributeId::Description).value_or(Variant{}));
    encode(writer, space.value(node));
    if (space.has_further_texts(node)) {
        for (const AttributeId attribute : {AttributeId::DisplayName, AttributeId::Description}) {
            for (const LocalizedText& text : space.texts(node, attribute)) {
                encode(writer, text);
            }
        }
    }
    const NodeAccess* const access = space.node_access(node);
    const std::size_t extras =
        access == nullptr
            ? 0
            : sizeof(NodeAccess) + access->role_permissions.size() * sizeof(RolePermissionType);
    return extras + record_and_slots + bytes_per_encoded_byte * writer.written() +
           space.variable(node).array_dimensions.size_bytes() +
           space.references(node).at_most() * detail::bytes_per_reference;
}

Result<NodeIndex> instantiate(AddressSpace& space, const NewNode& node, NodeIndex type,
                              const InstanceOptions& options)
{
    return detail::Instantiation{space, options}.create(node, type);
}

Result<void> add_optional(AddressSpace& space, NodeIndex instance, const InstanceOptions& options)
{
    const NodeIndex type = space.exists(instance) ? space.type_definition(instance) : no_node;
    if (type == no_node) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    return detail::Instantiation{space, options}.complete(instance, type);
}

Result<void> add_interface(AddressSpace& space, NodeIndex object, NodeIndex interface_type,
                           const InstanceOptions& options)
{
    if (!space.exists(object) || !space.exists(interface_type) ||
        !space.is_subtype_of(interface_type, id::BaseInterfaceType)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    return detail::Instantiation{space, options}.extend(object, interface_type);
}

Result<NodeIndex> add_add_in(AddressSpace& space, NodeIndex parent, NodeIndex type,
                             const NodeId& id, const InstanceOptions& options)
{
    if (!space.exists(parent) || !space.exists(type)) {
        return fail(space.exists(parent) ? status::Bad_TypeDefinitionInvalid
                                         : status::Bad_ParentNodeIdInvalid);
    }
    const auto name = default_name_of(space, type);
    if (!name) {
        return fail(name.error());
    }
    NewNode node;
    node.browse_name = *name;
    node.parent = parent;
    node.reference_type = NodeId{0, id::HasAddIn};
    node.id = id;
    if (id.is_null()) {
        const NodeId above = space.node_id(parent);
        node.id =
            options.ids == InstanceIds::Path && above.id_type() == IdType::String
                ? NodeId{above.namespace_index(), above.string().str() + '/' + name->name.str()}
                : space.free_id(above.namespace_index());
    }
    return instantiate(space, node, type, options);
}

NodeIndex find_by_path(const SpaceReader& space, NodeIndex from, std::string_view path)
{
    NodeIndex at = from;
    while (!path.empty() && at != no_node) {
        const std::size_t end = std::min(path.find('/'), path.size());
        const std::string_view name = path.substr(0, end);
        path.remove_prefix(std::min(end + 1, path.size()));
        ReferenceCursor cursor = space.references(at);
        at = no_node;
        while (const auto reference = cursor.next()) {
            if (reference->is_forward &&
                space.is_subtype_of(reference->type, id::HierarchicalReferences) &&
                space.browse_name(reference->target).name.view() == name) {
                at = reference->target;
                break;
            }
        }
    }
    return at;
}

} // namespace busbar::model

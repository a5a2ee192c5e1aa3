#include "node_changes.hpp"

#include <algorithm>

#include <busbar/binary/codec.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/model/instance.hpp>
#include <busbar/types/ids.hpp>

#include "core/utf8.hpp"

#include "node_attributes.hpp"

namespace busbar::server::detail {

namespace {

using model::NodeIndex;

/// Memory cost of a node, including the request's data; a decoded value exceeds its encoding by no
/// more than the headers of its fields.
std::size_t cost_of(const AddNodesItem& item)
{
    constexpr std::size_t record_references_and_slots = 256;
    return record_references_and_slots + model::node_watch_memory + 8 * binary::encoded_size(item);
}

bool has_type_definition(NodeClass node_class)
{
    return node_class == NodeClass::Object || node_class == NodeClass::Variable;
}

bool is_node_class(NodeClass node_class)
{
    const auto bits = static_cast<std::uint32_t>(node_class);
    return bits != 0 && bits <= 128 && (bits & (bits - 1)) == 0;
}

/// Returns the TypeDefinition, no_node for a NodeClass that has none.
Result<NodeIndex> find_type_definition(const NodeManagementContext& context,
                                       const AddNodesItem& item)
{
    if (!has_type_definition(item.node_class)) {
        const bool is_null = item.type_definition == ExpandedNodeId{};
        return is_null ? Result<NodeIndex>{model::no_node}
                       : fail(status::Bad_TypeDefinitionInvalid);
    }
    const NodeClass type_class =
        item.node_class == NodeClass::Object ? NodeClass::ObjectType : NodeClass::VariableType;
    const NodeIndex type = context.find(item.type_definition);
    if (type == model::no_node || context.space.node_class(type) != type_class ||
        context.space.is_abstract(type)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    return type;
}

/// Returns the NodeId of the new node: the requested one, or one of the server's own namespace.
Result<NodeId> choose_id(NodeManagementContext& context, const ExpandedNodeId& requested)
{
    if (requested == ExpandedNodeId{}) {
        return context.space.free_id(context.own_namespace);
    }
    // Namespace 0 belongs to the specification.
    if (!requested.is_local() || requested.node_id.namespace_index() == 0) {
        return fail(status::Bad_NodeIdRejected);
    }
    return requested.node_id;
}

/// Translates the address space's codes into those of the service.
StatusCode as_service_code(StatusCode code)
{
    if (code == status::Bad_TooManyOperations) { // more than InstanceLimits
        return status::Bad_OutOfMemory;
    }
    if (code == status::Bad_NodeIdInvalid) {
        return status::Bad_NodeIdRejected;
    }
    return code == status::Bad_TypeMismatch ? status::Bad_NodeAttributesInvalid : code;
}

/// Missing attributes are those of the VariableType (Part 4, 5.8.2.2).
model::NewVariable new_variable(const NodeManagementContext& context,
                                const NodeAttributeValues& from, NodeIndex type)
{
    const model::VariableAttributes of_type = context.space.variable(type);
    model::NewVariable to;
    to.type_definition = context.space.node_id(type);
    to.data_type = from.data_type.value_or(context.space.data_type_id(type));
    to.value_rank = from.value_rank.value_or(of_type.value_rank);
    to.array_dimensions =
        from.array_dimensions.value_or(Array<std::uint32_t>{of_type.array_dimensions});
    to.value = from.value.value_or(context.space.value(type));
    if (from.access_level) {
        to.access_level = model::Access{*from.access_level};
    }
    if (from.user_access_level) {
        to.user_access_level = model::Access{*from.user_access_level};
    }
    to.minimum_sampling_interval = from.minimum_sampling_interval.value_or(0);
    return to;
}

model::NewVariableType new_variable_type(const NodeManagementContext& context,
                                         const NodeAttributeValues& from, NodeIndex supertype)
{
    const model::VariableAttributes above = context.space.variable(supertype);
    model::NewVariableType to;
    to.data_type = from.data_type.value_or(context.space.data_type_id(supertype));
    to.value_rank = from.value_rank.value_or(above.value_rank);
    to.array_dimensions =
        from.array_dimensions.value_or(Array<std::uint32_t>{above.array_dimensions});
    to.value = from.value.value_or(Variant{});
    to.is_abstract = from.is_abstract.value_or(false);
    return to;
}

/// Adds an Object or Variable with the Mandatory members of its type (Part 4, 5.8.2.1). Their
/// NodeIds are numbers: ids made of names might be in use, or too long.
Result<NodeIndex> add_instance(NodeManagementContext& context, const model::NewNode& node,
                               NodeIndex type, const NodeAttributeValues& from)
{
    constexpr std::size_t visits_per_node = 200;
    model::InstanceOptions options;
    options.ids = model::InstanceIds::Numeric;
    options.limits.max_nodes = std::min(context.client_nodes.node_room(context.limits),
                                        context.visits_left / visits_per_node);
    options.limits.max_memory = context.client_nodes.memory_room(context.limits);
    options.event_notifier = from.event_notifier.value_or(0);
    if (context.space.node_class(type) == NodeClass::VariableType) {
        options.variable = new_variable(context, from, type);
    }
    const std::uint32_t before = context.space.addition_count();
    auto added = model::instantiate(context.space, node, type, options);
    const std::size_t made = context.space.addition_count() - before; // and removed again, perhaps
    context.visits_left -= std::min(context.visits_left, made * visits_per_node);
    return added;
}

Result<NodeIndex> add(NodeManagementContext& context, const model::NewNode& node,
                      NodeClass node_class, NodeIndex type, const NodeAttributeValues& from)
{
    model::AddressSpace& space = context.space;
    const bool is_abstract = from.is_abstract.value_or(false);
    switch (node_class) {
    case NodeClass::Object:
    case NodeClass::Variable:
        return add_instance(context, node, type, from);
    case NodeClass::Method: {
        model::NewMethod method;
        method.executable = from.executable.value_or(false); // no source carries it out
        return space.add_method(node, method);
    }
    case NodeClass::ObjectType:
        return space.add_object_type(node, is_abstract);
    case NodeClass::VariableType:
        return space.add_variable_type(node, new_variable_type(context, from, node.parent));
    case NodeClass::ReferenceType:
        return space.add_reference_type(
            node, {from.inverse_name, is_abstract, from.symmetric.value_or(false)});
    case NodeClass::DataType:
        return space.add_data_type(node, {from.definition, is_abstract});
    default:
        if (from.event_notifier.value_or(0) != 0) { // no View is a notifier here
            return fail(status::Bad_NodeAttributesInvalid);
        }
        return space.add_view(node, from.contains_no_loops.value_or(false));
    }
}

/// Charges the client's share for the node and its data.
void charge(NodeManagementContext& context, NodeIndex node, std::size_t bytes)
{
    const model::AddressSpace& space = context.space;
    if (!has_type_definition(space.node_class(node))) {
        return context.client_nodes.add(space, node, bytes);
    }
    space.for_each_below(node, [&](NodeIndex each) {
        context.client_nodes.add(space, each,
                                 model::memory_of(space, each) + model::node_watch_memory);
        return true;
    });
}

/// Returns the parent of the node and the reference to it.
Result<model::NewNode> place(NodeManagementContext& context, const AddNodesItem& item)
{
    model::NewNode node;
    node.parent = context.find(item.parent_node_id);
    if (node.parent == model::no_node) {
        return fail(status::Bad_ParentNodeIdInvalid);
    }
    const StatusCode refusal = context.rights.check_add_node(node.parent);
    if (refusal.is_bad()) {
        return fail(refusal);
    }
    if (context.find_reference_type(item.reference_type_id) == model::no_node) {
        return fail(status::Bad_ReferenceTypeIdInvalid);
    }
    if (!is_node_class(item.node_class)) {
        return fail(status::Bad_NodeClassInvalid);
    }
    if (!busbar::detail::is_name(item.browse_name.name.view())) {
        return fail(status::Bad_BrowseNameInvalid);
    }
    node.reference_type = item.reference_type_id;
    node.browse_name = item.browse_name;
    return node;
}

} // namespace

Result<NodeId> add_node(NodeManagementContext& context, const AddNodesItem& item)
{
    auto node = place(context, item);
    const auto type = node ? find_type_definition(context, item) : fail(node.error());
    if (!type) {
        return fail(type.error());
    }
    const model::AddressSpace& space = context.space;
    const StatusCode bad = check_ends(space, space.find(item.reference_type_id),
                                      reference_end(space, node->parent), {item.node_class, *type});
    auto id = bad.is_bad() ? fail(bad) : choose_id(context, item.requested_new_node_id);
    const auto attributes =
        id ? read_attributes(item.node_attributes, item.node_class) : fail(id.error());
    if (!attributes) {
        return fail(attributes.error());
    }
    const std::size_t bytes = cost_of(item);
    if (!context.client_nodes.has_room(context.limits, bytes)) {
        return fail(status::Bad_OutOfMemory);
    }
    node->id = *std::move(id);
    node->display_name = attributes->display_name;
    node->description = attributes->description;
    const auto added = add(context, *node, item.node_class, *type, *attributes);
    if (!added) {
        return fail(as_service_code(added.error()));
    }
    busbar::detail::Undo undo{[&] { static_cast<void>(context.space.remove(*added)); }};
    charge(context, *added, bytes);
    undo.keep();
    return std::move(node->id);
}

} // namespace busbar::server::detail

#include "space_builder.hpp"

#include <busbar/types/ids.hpp>

namespace busbar::tool {

namespace {

using model::NewNode;
using model::no_node;
using model::NodeIndex;

bool is_type(NodeClass node_class)
{
    return node_class == NodeClass::ObjectType || node_class == NodeClass::VariableType ||
           node_class == NodeClass::ReferenceType || node_class == NodeClass::DataType;
}

NodeId type_definition_of(const RemoteNode& node)
{
    for (const ReferenceDescription& reference : node.references) {
        if (reference.is_forward && reference.reference_type_id.is(id::HasTypeDefinition)) {
            return reference.node_id.node_id;
        }
    }
    return {};
}

Variant value_of(const RemoteNode& node, bool with_value)
{
    const auto found = node.attributes.find(AttributeId::Value);
    return with_value && found != node.attributes.end() ? found->second : Variant{};
}

Array<std::uint32_t> dimensions_of(const RemoteNode& node)
{
    const auto found = node.attributes.find(AttributeId::ArrayDimensions);
    const auto* dimensions =
        found == node.attributes.end() ? nullptr : found->second.array_if<std::uint32_t>();
    return dimensions == nullptr ? Array<std::uint32_t>{} : *dimensions;
}

} // namespace

SpaceBuilder::SpaceBuilder(const std::vector<std::string>& namespaces)
{
    for (std::size_t i = 1; i < namespaces.size(); ++i) {
        const auto index = space_.add_namespace(namespaces[i]);
        if (!index || *index != i) {
            throw Failure{Exit::Failed, namespaces[i] + ": the server has this namespace twice"};
        }
    }
}

void SpaceBuilder::add(const std::vector<RemoteNode>& nodes)
{
    std::vector<const RemoteNode*> pending;
    for (const RemoteNode& node : nodes) {
        pending.push_back(&node);
    }
    for (std::size_t before = pending.size() + 1; pending.size() < before;) {
        before = pending.size();
        std::erase_if(pending, [this](const RemoteNode* node) { return add_node(*node); });
    }
    for (const RemoteNode* node : pending) {
        left_out_.push_back(node->id);
    }
    for (const RemoteNode& node : nodes) {
        if (space_.find(node.id) != no_node) {
            add_references(node);
        }
    }
}

bool SpaceBuilder::is_parent_reference(const RemoteNode& node,
                                       const ReferenceDescription& reference) const
{
    if (reference.is_forward || space_.find(reference.node_id.node_id) == no_node) {
        return false;
    }
    if (is_type(node.node_class)) {
        return reference.reference_type_id.is(id::HasSubtype);
    }
    const NodeIndex type = space_.find(reference.reference_type_id);
    return reference.reference_type_id.is(id::HasEncoding) ||
           space_.is_subtype_of(type, id::HierarchicalReferences);
}

bool SpaceBuilder::add_node(const RemoteNode& node)
{
    for (const ReferenceDescription& reference : node.references) {
        if (!is_parent_reference(node, reference)) {
            continue;
        }
        NewNode what;
        what.id = node.id;
        what.browse_name = node.get<QualifiedName>(AttributeId::BrowseName);
        what.display_name = node.get<LocalizedText>(AttributeId::DisplayName);
        what.description = node.get<LocalizedText>(AttributeId::Description);
        what.parent = space_.find(reference.node_id.node_id);
        what.reference_type = reference.reference_type_id;
        auto added = add_as(node, what, true);
        if (!added && added.error() == status::Bad_TypeMismatch) {
            added = add_as(node, what, false);
            if (added) {
                without_value_.push_back(node.id);
            }
        }
        if (added) {
            return true;
        }
    }
    return false;
}

Result<NodeIndex> SpaceBuilder::add_as(const RemoteNode& node, const NewNode& what, bool with_value)
{
    switch (node.node_class) {
    case NodeClass::Object: {
        model::NewObject object;
        object.type_definition = type_definition_of(node);
        object.event_notifier = node.get<std::uint8_t>(AttributeId::EventNotifier);
        return space_.add_object(what, object);
    }
    case NodeClass::Variable:
        return add_variable(node, what, with_value);
    case NodeClass::Method: {
        // Its arguments are nodes of their own.
        model::NewMethod method;
        method.executable = node.get<bool>(AttributeId::Executable, true);
        return space_.add_method(what, method);
    }
    case NodeClass::View:
        return space_.add_view(what, node.get<bool>(AttributeId::ContainsNoLoops));
    default:
        return add_type(node, what, with_value);
    }
}

Result<NodeIndex> SpaceBuilder::add_variable(const RemoteNode& node, const NewNode& what,
                                             bool with_value)
{
    model::NewVariable variable;
    variable.data_type = node.get<NodeId>(AttributeId::DataType);
    variable.value_rank = node.get<std::int32_t>(AttributeId::ValueRank, -1);
    variable.array_dimensions = dimensions_of(node);
    variable.access_level = model::Access{node.get<std::uint8_t>(AttributeId::AccessLevel, 1)};
    variable.minimum_sampling_interval = node.get<double>(AttributeId::MinimumSamplingInterval);
    variable.historizing = node.get<bool>(AttributeId::Historizing);
    variable.value = value_of(node, with_value);
    variable.type_definition = type_definition_of(node);
    return space_.add_variable(what, variable);
}

Result<NodeIndex> SpaceBuilder::add_type(const RemoteNode& node, const NewNode& what,
                                         bool with_value)
{
    const bool is_abstract = node.get<bool>(AttributeId::IsAbstract);
    switch (node.node_class) {
    case NodeClass::ObjectType:
        return space_.add_object_type(what, is_abstract);
    case NodeClass::VariableType: {
        model::NewVariableType type;
        type.data_type = node.get<NodeId>(AttributeId::DataType, type.data_type);
        type.value_rank = node.get<std::int32_t>(AttributeId::ValueRank, -2);
        type.array_dimensions = dimensions_of(node);
        type.value = value_of(node, with_value);
        type.is_abstract = is_abstract;
        return space_.add_variable_type(what, type);
    }
    case NodeClass::ReferenceType: {
        model::NewReferenceType type;
        type.inverse_name = node.get<LocalizedText>(AttributeId::InverseName);
        type.is_abstract = is_abstract;
        type.symmetric = node.get<bool>(AttributeId::Symmetric);
        return space_.add_reference_type(what, type);
    }
    case NodeClass::DataType: {
        model::NewDataType type;
        type.definition = node.get<ExtensionObject>(AttributeId::DataTypeDefinition);
        type.is_abstract = is_abstract;
        return space_.add_data_type(what, type);
    }
    default:
        return fail(status::Bad_NodeClassInvalid);
    }
}

void SpaceBuilder::add_references(const RemoteNode& node)
{
    for (const ReferenceDescription& reference : node.references) {
        const NodeIndex here = space_.find(node.id);
        const NodeIndex there = space_.find(reference.node_id.node_id);
        if (there == no_node || !reference.node_id.is_local()) {
            continue;
        }
        // A reference that was added with the node exists already; adding it again is refused.
        static_cast<void>(reference.is_forward
                              ? space_.add_reference(here, reference.reference_type_id, there)
                              : space_.add_reference(there, reference.reference_type_id, here));
    }
}

} // namespace busbar::tool

#include "event_fields.hpp"

#include <functional>

namespace busbar::server::detail {

namespace {

using model::no_node;
using model::NodeIndex;

std::size_t hash(const QualifiedName& name)
{
    return std::hash<std::string_view>{}(name.name.view()) ^ name.namespace_index;
}

bool is_instance(NodeClass node_class)
{
    return node_class == NodeClass::Object || node_class == NodeClass::Variable;
}

/// Returns a field that every event has, even if namespace 0 lacks it.
FieldDeclaration base_declaration(BaseField field)
{
    FieldDeclaration declaration;
    declaration.is_divisible = field == BaseField::EventId || field == BaseField::SourceName;
    return declaration;
}

} // namespace

std::optional<FieldDeclaration> EventFields::find(NodeIndex type, FieldPath path)
{
    if (const auto base = find_base_field(path)) {
        return base_declaration(*base);
    }
    std::optional<FieldDeclaration> found;
    for_each_declaration(type, path, [&](NodeIndex, NodeIndex node) {
        found = found ? found : FieldDeclaration{};
        add(node, *found);
    });
    return found;
}

void EventFields::for_each_declaration(NodeIndex type, FieldPath path,
                                       FunctionRef<void(NodeIndex, NodeIndex)> visit)
{
    refresh();
    const auto [first, last] = by_name_.equal_range(hash(path[0]));
    for (auto entry = first; entry != last; ++entry) {
        NodeIndex node = entry->second.node;
        if (!is_of(type, entry->second) || !(space_->browse_name(node) == path[0])) {
            continue;
        }
        for (const QualifiedName& name : path.subspan(1)) {
            node = node == no_node ? no_node : find_member(node, name);
        }
        if (node != no_node) {
            visit(entry->second.owner, node);
        }
    }
}

void EventFields::find_guards(NodeIndex type, FieldPath path, std::vector<FieldGuard>& guards)
{
    for_each_declaration(type, path, [&](NodeIndex owner, NodeIndex node) {
        if (space_->role_permissions(node) != nullptr) {
            guards.push_back({owner, space_->handle(node)});
        }
    });
}

std::uint64_t EventFields::version()
{
    refresh();
    return rounds_ + space_->journal().access_changes(); // neither ever decreases
}

void EventFields::refresh()
{
    if (is_noted_) {
        return;
    }
    ++rounds_;
    watches_.clear();
    by_name_.clear();
    std::vector<NodeIndex> types;
    if (const NodeIndex base = space_->find(id::BaseEventType); base != no_node) {
        types.push_back(base);
    }
    const NodeIndex has_subtype = space_->find(id::HasSubtype);
    for (std::size_t i = 0; i < types.size(); ++i) {
        note(types[i]);
        model::ReferenceCursor references = space_->references(types[i]);
        while (const auto reference = references.next()) {
            if (reference->is_forward && reference->type == has_subtype) {
                types.push_back(reference->target);
            }
        }
    }
    is_noted_ = !types.empty();
}

void EventFields::note(NodeIndex type)
{
    space_->journal().watch(type, model::NodeAspect::References, watches_.emplace_back(is_noted_));
    const NodeIndex hierarchical = space_->find(id::HierarchicalReferences);
    model::ReferenceCursor references = space_->references(type);
    while (const auto reference = references.next()) {
        if (reference->is_forward && is_instance(space_->node_class(reference->target)) &&
            space_->is_subtype_of(reference->type, hierarchical)) {
            by_name_.emplace(hash(space_->browse_name(reference->target)),
                             Declaration{type, reference->target});
        }
    }
}

bool EventFields::is_of(NodeIndex type, const Declaration& declaration) const
{
    return space_->is_subtype_of(type, declaration.owner) ||
           space_->is_subtype_of(declaration.owner, type);
}

NodeIndex EventFields::find_own_member(NodeIndex node, const QualifiedName& name) const
{
    NodeIndex found = no_node;
    space_->for_each_child(node, space_->find(id::HierarchicalReferences), true, name,
                           [&](NodeIndex child) {
                               if (is_instance(space_->node_class(child))) {
                                   found = child;
                               }
                               return found == no_node;
                           });
    return found;
}

NodeIndex EventFields::find_member(NodeIndex node, const QualifiedName& name) const
{
    NodeIndex found = find_own_member(node, name);
    NodeIndex type = space_->type_definition(node);
    while (found == no_node && type != no_node) {
        found = find_own_member(type, name);
        type = space_->supertype(type);
    }
    return found;
}

void EventFields::add(NodeIndex node, FieldDeclaration& field) const
{
    if (space_->node_class(node) == NodeClass::Object) {
        field.is_object = true;
        return;
    }
    const model::VariableAttributes variable = space_->variable(node);
    const BuiltInType type = space_->built_in_type_of(variable.data_type);
    // A DataType that is missing in a small namespace 0 may be anything.
    const bool is_text = type == BuiltInType::String || type == BuiltInType::ByteString ||
                         type == BuiltInType::Variant || type == BuiltInType::Null;
    constexpr std::int32_t scalar = -1;
    field.is_divisible = field.is_divisible || is_text || variable.value_rank != scalar;
    field.is_status = field.is_status || type == BuiltInType::StatusCode;
}

} // namespace busbar::server::detail

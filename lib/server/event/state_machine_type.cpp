#include "state_machine_type.hpp"

#include <algorithm>

#include <busbar/model/instance.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::server::detail {

using model::AddressSpace;
using model::no_node;
using model::NodeIndex;
using model::Reference;
using model::ReferenceCursor;

namespace {

LocalizedText owned(const LocalizedText& text)
{
    return {text.locale.is_null() ? String{} : String{text.locale.view()},
            String{text.text.view()}};
}

QualifiedName owned(const QualifiedName& name)
{
    return {name.namespace_index, String{name.name.view()}};
}

std::uint32_t number_of(const AddressSpace& space, NodeIndex node, const char* property)
{
    const NodeIndex found = model::find_by_path(space, node, property);
    const Variant value = found == no_node ? Variant{} : space.value(found);
    const auto* const number = value.get_if<std::uint32_t>();
    return number == nullptr ? 0 : *number;
}

/// Calls `visit` for each forward target by `type` or a subtype.
template <typename Visit>
void for_each_target(const AddressSpace& space, NodeIndex node, std::uint32_t type, Visit visit)
{
    ReferenceCursor cursor = space.references(node);
    while (const auto reference = cursor.next()) {
        if (reference->is_forward && space.is_subtype_of(reference->type, type)) {
            visit(reference->target);
        }
    }
}

/// Returns the components of the type and its supertypes whose type is `kind`; of those with equal
/// BrowseNames the most derived.
std::vector<NodeIndex> components(const AddressSpace& space, NodeIndex type, std::uint32_t kind)
{
    std::vector<NodeIndex> found;
    for (NodeIndex at = type; at != no_node; at = space.supertype(at)) {
        for_each_target(space, at, id::HasComponent, [&](NodeIndex component) {
            const auto has_its_name = [&](NodeIndex other) {
                return space.browse_name(other) == space.browse_name(component);
            };
            if (space.node_class(component) == NodeClass::Object &&
                space.is_subtype_of(space.type_definition(component), kind) &&
                std::none_of(found.begin(), found.end(), has_its_name)) {
                found.push_back(component);
            }
        });
    }
    return found;
}

MachineState read_state(const AddressSpace& space, NodeIndex node)
{
    MachineState state;
    state.id = space.node_id(node);
    state.browse_name = owned(space.browse_name(node));
    state.display_name = owned(space.display_name(node));
    state.number = number_of(space, node, "StateNumber");
    state.is_initial = space.is_subtype_of(space.type_definition(node), id::InitialStateType);
    return state;
}

Result<MachineTransition> read_transition(const AddressSpace& space, NodeIndex node,
                                          const StateMachineType& type)
{
    MachineTransition transition;
    transition.id = space.node_id(node);
    transition.browse_name = owned(space.browse_name(node));
    transition.display_name = owned(space.display_name(node));
    transition.number = number_of(space, node, "TransitionNumber");
    std::optional<std::size_t> from;
    std::optional<std::size_t> to;
    for_each_target(space, node, id::FromState,
                    [&](NodeIndex state) { from = type.find(space.node_id(state)); });
    for_each_target(space, node, id::ToState,
                    [&](NodeIndex state) { to = type.find(space.node_id(state)); });
    if (!from || !to) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    transition.from = *from;
    transition.to = *to;
    for_each_target(space, node, id::HasCause,
                    [&](NodeIndex method) { transition.causes.push_back(space.node_id(method)); });
    for_each_target(space, node, id::HasEffect, [&](NodeIndex event_type) {
        transition.effects.push_back(space.node_id(event_type));
    });
    return transition;
}

} // namespace

std::optional<std::size_t> StateMachineType::find(const NodeId& state) const
{
    for (std::size_t i = 0; i < states.size(); ++i) {
        if (states[i].id == state) {
            return i;
        }
    }
    return std::nullopt;
}

Result<StateMachineType> read_state_machine_type(const AddressSpace& space, NodeIndex type)
{
    StateMachineType result;
    if (!space.is_subtype_of(type, id::FiniteStateMachineType)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    for (const NodeIndex state : components(space, type, id::StateType)) {
        result.states.push_back(read_state(space, state));
    }
    for (const NodeIndex node : components(space, type, id::TransitionType)) {
        auto transition = read_transition(space, node, result);
        if (!transition) {
            return fail(transition.error());
        }
        result.transitions.push_back(std::move(*transition));
    }
    if (result.states.empty()) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    return result;
}

std::vector<SubMachineDeclaration> sub_machines_of(const AddressSpace& space,
                                                   const StateMachineType& type)
{
    std::vector<SubMachineDeclaration> found;
    for (std::size_t i = 0; i < type.states.size(); ++i) {
        for_each_target(
            space, space.find(type.states[i].id), id::HasSubStateMachine, [&](NodeIndex machine) {
                const QualifiedName name = owned(space.browse_name(machine));
                const auto known = std::find_if(
                    found.begin(), found.end(),
                    [&](const SubMachineDeclaration& other) { return other.browse_name == name; });
                if (known == found.end()) {
                    found.push_back({name, {i}});
                } else {
                    known->states.push_back(i);
                }
            });
    }
    return found;
}

} // namespace busbar::server::detail

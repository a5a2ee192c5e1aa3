#pragma once

#include <vector>

#include <busbar/server/state_machine.hpp>

namespace busbar::server::detail {

/// The states and transitions of a type, in the order of their declaration.
struct StateMachineType {
    std::vector<MachineState> states;
    std::vector<MachineTransition> transitions;

    /// Returns the index of the state's Object, or nothing.
    [[nodiscard]] std::optional<std::size_t> find(const NodeId& state) const;
};

/// A machine below a state, the target of the state's HasSubStateMachine.
struct SubMachineDeclaration {
    QualifiedName browse_name;
    std::vector<std::size_t> states;
};

/// Reads a subtype of FiniteStateMachineType including its supertypes' members.
/// Bad_TypeDefinitionInvalid if it is not such a type, has no state, or a transition lacks
/// FromState or ToState (Part 16, 4.4.5).
[[nodiscard]] Result<StateMachineType> read_state_machine_type(const model::AddressSpace& space,
                                                               model::NodeIndex type);

/// Returns the sub-machines of the type's states.
[[nodiscard]] std::vector<SubMachineDeclaration> sub_machines_of(const model::AddressSpace& space,
                                                                 const StateMachineType& type);

} // namespace busbar::server::detail

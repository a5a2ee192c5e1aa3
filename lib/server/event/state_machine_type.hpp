#pragma once

#include <vector>

#include <busbar/server/state_machine.hpp>

namespace busbar::server::detail {

/// The states and transitions of a type, in the order of their declaration.
struct StateMachineType {
    std::vector<MachineState> states;
    std::vector<MachineTransition> transitions;

    /// The index of the state's Object, or nothing.
    [[nodiscard]] std::optional<std::size_t> find(const NodeId& state) const;
};

/// A machine below a state: what the state's HasSubStateMachine leads to.
struct SubMachineDeclaration {
    QualifiedName browse_name;
    std::vector<std::size_t> states;
};

/// Reads a subtype of FiniteStateMachineType with what its supertypes have.
/// Bad_TypeDefinitionInvalid if it is none, has no state, or a transition lacks FromState or
/// ToState (Part 16, 4.4.5).
[[nodiscard]] Result<StateMachineType> read_state_machine_type(const model::AddressSpace& space,
                                                               model::NodeIndex type);

/// The sub-machines of the type's states.
[[nodiscard]] std::vector<SubMachineDeclaration> sub_machines_of(const model::AddressSpace& space,
                                                                 const StateMachineType& type);

} // namespace busbar::server::detail

#include <busbar/server/state_machine.hpp>

#include <string>
#include <utility>

/// The Variables and events of a StateMachine.
namespace busbar::server {

void StateMachine::set(const Slot& slot, Variant value, StatusCode status)
{
    if (slot.is_there) {
        context_.memory->set(slot.handle, std::move(value), status);
    }
}

/// Returns the state with that of its active sub-machines (Part 16, 4.4.3).
LocalizedText StateMachine::effective_name() const
{
    LocalizedText name = states_[*current_].display_name;
    for (const SubMachine& sub : sub_machines_) {
        if (sub.machine->current_) {
            name.text = String{name.text.str() + '/' + sub.machine->effective_name().text.str()};
        }
    }
    return name;
}

void StateMachine::show_state()
{
    const MachineState& state = states_[*current_];
    set(state_slots_.value, state.display_name);
    set(state_slots_.id, state.id);
    set(state_slots_.name, state.browse_name);
    set(state_slots_.number, state.number);
    show_effective_names();
}

/// Updates this machine and those above, which change with it.
void StateMachine::show_effective_names()
{
    for (StateMachine* at = this; at != nullptr && at->current_; at = at->parent_) {
        at->set(at->state_slots_.effective_name, at->effective_name());
    }
}

void StateMachine::show_no_transition()
{
    set(transition_slots_.value, LocalizedText{});
    set(transition_slots_.id, NodeId{});
    set(transition_slots_.name, QualifiedName{});
    set(transition_slots_.number, std::uint32_t{0});
    set(transition_slots_.time, DateTime{});
    set(transition_slots_.effective_time, DateTime{});
}

void StateMachine::show_transition(DateTime time)
{
    const MachineTransition& transition = transitions_[*last_];
    set(transition_slots_.value, transition.display_name);
    set(transition_slots_.id, transition.id);
    set(transition_slots_.name, transition.browse_name);
    set(transition_slots_.number, transition.number);
    set(transition_slots_.time, time);
    set(transition_slots_.effective_time, time);
}

void StateMachine::show_inactive(const Slots& slots)
{
    for (const Slot& slot : {slots.value, slots.id, slots.name, slots.number, slots.effective_name,
                             slots.time, slots.effective_time}) {
        set(slot, {}, status::Bad_StateNotActive);
    }
}

void StateMachine::show_available()
{
    Array<NodeId> states;
    states.reserve(states_.size());
    for (const MachineState& state : states_) {
        if (state.is_available) {
            states.push_back(state.id);
        }
    }
    Array<NodeId> transitions;
    transitions.reserve(transitions_.size());
    for (const MachineTransition& transition : transitions_) {
        if (is_available(transition)) {
            transitions.push_back(transition.id);
        }
    }
    set(available_states_, std::move(states));
    set(available_transitions_, std::move(transitions));
}

/// Raises the events of the effects that concern transitions (Part 16, 4.4.15 and 4.4.17);
/// additional content of Alarms or audit events is unknown to this machine.
void StateMachine::raise(const MachineTransition& transition, DateTime time)
{
    if (context_.events == nullptr) {
        return;
    }
    bool is_raised = false;
    for (const NodeId& effect : transition.effects) {
        if (context_.space->is_subtype_of(context_.space->find(effect), id::TransitionEventType)) {
            raise(transition, effect, time);
            is_raised = true;
        }
    }
    if (!is_raised && !context_.default_event_type.is_null()) {
        raise(transition, context_.default_event_type, time);
    }
}

void StateMachine::raise(const MachineTransition& transition, const NodeId& event_type,
                         DateTime time)
{
    Event event;
    event.event_type = event_type;
    event.source_node = object_;
    event.source_name = source_name_;
    event.message = transition.display_name;
    event.time = time;
    const auto add = [&](const char* field, const LocalizedText& text, const NodeId& id,
                         std::uint32_t number) {
        event.set({0, field}, text);
        event.set({{0, field}, {0, "Id"}}, id);
        event.set({{0, field}, {0, "Number"}}, number);
    };
    const MachineState& from = states_[transition.from];
    const MachineState& to = states_[transition.to];
    add("Transition", transition.display_name, transition.id, transition.number);
    add("FromState", from.display_name, from.id, from.number);
    add("ToState", to.display_name, to.id, to.number);
    // A full queue counts the events it drops.
    static_cast<void>(context_.events->raise(std::move(event)));
}

} // namespace busbar::server

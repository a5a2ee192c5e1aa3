#include <busbar/server/state_machine.hpp>

#include <algorithm>
#include <string>
#include <utility>

#include <busbar/model/instance.hpp>

#include "state_machine_type.hpp"

namespace busbar::server {

using model::no_node;
using model::NodeIndex;

namespace {

/// The model, which may come from a file, determines the nesting of machines.
constexpr std::size_t max_depth = 8;

} // namespace

StateMachine::~StateMachine() = default;

Result<std::unique_ptr<StateMachine>> StateMachine::attach(const StateMachineContext& context,
                                                           const NodeId& object)
{
    const NodeIndex node = context.space->find(object);
    if (node == no_node) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    auto machine = attach(context, node, 1);
    if (machine) {
        // The nodes are changed only now, when nothing can fail any more.
        (*machine)->take_over();
    }
    return machine;
}

Result<std::unique_ptr<StateMachine>> StateMachine::attach(const StateMachineContext& context,
                                                           NodeIndex object, std::size_t depth)
{
    if (depth > max_depth) {
        return fail(status::Bad_TooManyOperations);
    }
    auto type =
        detail::read_state_machine_type(*context.space, context.space->type_definition(object));
    if (!type) {
        return fail(type.error());
    }
    std::unique_ptr<StateMachine> machine{new StateMachine{context}};
    machine->object_ = context.space->node_id(object);
    machine->source_name_ = String{context.space->browse_name(object).name.view()};
    machine->states_ = std::move(type->states);
    machine->transitions_ = std::move(type->transitions);
    if (auto attached = machine->attach_sub_machines(object, depth); !attached) {
        return fail(attached.error());
    }
    return machine;
}

void StateMachine::take_over()
{
    for (const SubMachine& sub : sub_machines_) {
        sub.machine->take_over();
    }
    take_variables(context_.space->find(object_));
    deactivate();
    show_available();
}

Result<void> StateMachine::attach_sub_machines(NodeIndex object, std::size_t depth)
{
    const detail::StateMachineType type{states_, {}};
    for (auto& declared : detail::sub_machines_of(*context_.space, type)) {
        NodeIndex node = no_node;
        static_cast<void>(
            context_.space->for_each_child(object, context_.space->find(id::HasComponent), true,
                                           declared.browse_name, [&](NodeIndex child) {
                                               node = child;
                                               return false;
                                           }));
        if (node == no_node) {
            continue;
        }
        auto machine = attach(context_, node, depth + 1);
        if (!machine) {
            return fail(machine.error());
        }
        (*machine)->parent_ = this;
        sub_machines_.push_back(
            {std::move(declared.browse_name), std::move(declared.states), std::move(*machine)});
    }
    return {};
}

StateMachine::Slot StateMachine::take_variable(NodeIndex object, std::string_view path)
{
    const NodeIndex node = model::find_by_path(*context_.space, object, path);
    if (node == no_node) {
        return {};
    }
    const std::uint64_t handle = context_.memory->add({});
    context_.space->bind(node, context_.source, handle);
    return {true, handle};
}

StateMachine::Slots StateMachine::take_variables(NodeIndex object, const char* name)
{
    const std::string path{name};
    Slots slots;
    slots.value = take_variable(object, path);
    slots.id = take_variable(object, path + "/Id");
    slots.name = take_variable(object, path + "/Name");
    slots.number = take_variable(object, path + "/Number");
    slots.effective_name = take_variable(object, path + "/EffectiveDisplayName");
    slots.time = take_variable(object, path + "/TransitionTime");
    slots.effective_time = take_variable(object, path + "/EffectiveTransitionTime");
    return slots;
}

void StateMachine::take_variables(NodeIndex object)
{
    state_slots_ = take_variables(object, "CurrentState");
    transition_slots_ = take_variables(object, "LastTransition");
    available_states_ = take_variable(object, "AvailableStates");
    available_transitions_ = take_variable(object, "AvailableTransitions");
}

const MachineState* StateMachine::current() const
{
    return current_ ? &states_[*current_] : nullptr;
}

const MachineTransition* StateMachine::last_transition() const
{
    return last_ ? &transitions_[*last_] : nullptr;
}

std::optional<std::size_t> StateMachine::find_state(std::string_view name) const
{
    for (std::size_t i = 0; i < states_.size(); ++i) {
        if (states_[i].browse_name.name.view() == name) {
            return i;
        }
    }
    return std::nullopt;
}

StateMachine* StateMachine::sub_machine(std::string_view name)
{
    for (SubMachine& sub : sub_machines_) {
        if (sub.browse_name.name.view() == name) {
            return sub.machine.get();
        }
    }
    return nullptr;
}

/// A sub-machine is active only in certain states of the machine above (Part 16, 4.4.16).
bool StateMachine::may_be_active() const
{
    if (parent_ == nullptr) {
        return true;
    }
    for (const SubMachine& sub : parent_->sub_machines_) {
        if (sub.machine.get() == this) {
            return parent_->current_ && std::find(sub.states.begin(), sub.states.end(),
                                                  *parent_->current_) != sub.states.end();
        }
    }
    return false;
}

Result<void> StateMachine::activate()
{
    if (!may_be_active()) {
        return fail(status::Bad_StateNotActive);
    }
    const auto initial =
        std::find_if(states_.begin(), states_.end(), [](const MachineState& state) {
            return state.is_initial && state.is_available;
        });
    if (current_ || initial == states_.end()) {
        return fail(status::Bad_InvalidState);
    }
    enter(static_cast<std::size_t>(initial - states_.begin()));
    return {};
}

void StateMachine::deactivate()
{
    for (const SubMachine& sub : sub_machines_) {
        sub.machine->deactivate();
    }
    current_.reset();
    last_.reset();
    show_inactive(state_slots_);
    show_inactive(transition_slots_);
}

Result<void> StateMachine::set_state(std::string_view state, DateTime time)
{
    const auto target = find_state(state);
    if (!target) {
        return fail(status::Bad_NotFound);
    }
    if (!states_[*target].is_available) {
        return fail(status::Bad_InvalidState);
    }
    if (!may_be_active()) {
        return fail(status::Bad_StateNotActive);
    }
    if (!current_) {
        enter(*target);
        return {};
    }
    for (const MachineTransition& transition : transitions_) {
        if (transition.from == *current_ && transition.to == *target) {
            return try_transition(transition, time);
        }
    }
    return fail(status::Bad_InvalidState);
}

Result<void> StateMachine::take(std::string_view transition, DateTime time)
{
    for (const MachineTransition& each : transitions_) {
        if (each.browse_name.name.view() == transition) {
            return try_transition(each, time);
        }
    }
    return fail(status::Bad_NotFound);
}

Result<void> StateMachine::call(const NodeId& method, DateTime time)
{
    for (const MachineTransition& transition : transitions_) {
        const bool is_cause = std::find(transition.causes.begin(), transition.causes.end(),
                                        method) != transition.causes.end();
        if (is_cause && current_ == transition.from && is_available(transition)) {
            return try_transition(transition, time);
        }
    }
    return fail(status::Bad_InvalidState);
}

bool StateMachine::is_available(const MachineTransition& transition) const
{
    return states_[transition.from].is_available && states_[transition.to].is_available;
}

Result<void> StateMachine::try_transition(const MachineTransition& transition, DateTime time)
{
    if (current_ != transition.from || !is_available(transition)) {
        return fail(status::Bad_InvalidState);
    }
    follow(transition, time);
    return {};
}

void StateMachine::follow(const MachineTransition& transition, DateTime time)
{
    last_ = static_cast<std::size_t>(&transition - transitions_.data());
    enter(transition.to);
    show_transition(time);
    raise(transition, time);
}

/// Makes `state` the current one. Its sub-machines start again, those of other states end.
void StateMachine::enter(std::size_t state)
{
    current_ = state;
    for (const SubMachine& sub : sub_machines_) {
        sub.machine->deactivate();
        const bool is_of_it =
            std::find(sub.states.begin(), sub.states.end(), state) != sub.states.end();
        if (is_of_it) {
            // Without an initial state it waits for set_state.
            static_cast<void>(sub.machine->activate());
        }
    }
    show_state();
    if (!last_) {
        show_no_transition();
    }
}

Result<void> StateMachine::set_available_states(std::span<const std::string_view> states)
{
    std::vector<bool> is_available(states_.size(), false);
    for (const std::string_view name : states) {
        const auto found = find_state(name);
        if (!found) {
            return fail(status::Bad_NotFound);
        }
        is_available[*found] = true;
    }
    if (current_ && !is_available[*current_]) {
        return fail(status::Bad_InvalidState);
    }
    for (std::size_t i = 0; i < states_.size(); ++i) {
        states_[i].is_available = is_available[i];
    }
    show_available();
    return {};
}

} // namespace busbar::server

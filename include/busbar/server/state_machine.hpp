#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/event.hpp>
#include <busbar/server/memory_source.hpp>

/// State machines of FiniteStateMachineType (Part 16, 4.4.5), with the states and transitions of
/// their type: an application sets the state, and Variables and events follow.
namespace busbar::server {

/// A StateType Object of the type.
struct MachineState {
    NodeId id;
    QualifiedName browse_name;
    LocalizedText display_name;
    /// The StateNumber.
    std::uint32_t number{0};
    /// True for a state of InitialStateType.
    bool is_initial{false};
    /// False after set_available_states without it.
    bool is_available{true};
};

/// A TransitionType Object of the type.
struct MachineTransition {
    NodeId id;
    QualifiedName browse_name;
    LocalizedText display_name;
    /// The TransitionNumber, 0 if it has none.
    std::uint32_t number{0};
    /// Indices into StateMachine::states().
    std::size_t from{0};
    std::size_t to{0};
    /// The Methods of HasCause and the EventTypes of HasEffect.
    std::vector<NodeId> causes;
    std::vector<NodeId> effects;
};

/// The objects that a StateMachine works with; all of them must outlive the machine.
struct StateMachineContext {
    model::AddressSpace* space{nullptr};
    /// Serves the machine's Variables, so that they have a status and the time of their change.
    MemorySource* memory{nullptr};
    /// The index that Server::add_source returned for `memory`.
    std::uint32_t source{model::no_source};
    /// If null, no events are raised.
    EventQueue* events{nullptr};
    /// TransitionEventType or a subtype, for transitions whose type does not name an effect, as in
    /// PackML (Part 16, 4.4.2); if null, these raise no event.
    NodeId default_event_type;
};

/// One Object of a subtype of FiniteStateMachineType, created by model::instantiate.
///
/// A machine begins inactive: CurrentState and LastTransition have Bad_StateNotActive (Part 16,
/// 4.4.20). If it has sub-machines, those of the current state are active (4.4.16): they begin in
/// their initial state, or wait for set_state if they have none.
///
/// Used on the server's thread only. A call that fails changes nothing.
class BUSBAR_API StateMachine {
public:
    /// Reads states and transitions from the Object's type and serves its Variables from now on:
    /// CurrentState, LastTransition, AvailableStates and AvailableTransitions, with those of their
    /// Properties that the instance has. Finds the sub-machines, which are components of the
    /// Object. Bad_TypeDefinitionInvalid if `object` is not such an Object or its type has no state
    /// or a transition without FromState or ToState; Bad_TooManyOperations if machines are nested
    /// more than 8 deep.
    [[nodiscard]] static Result<std::unique_ptr<StateMachine>>
    attach(const StateMachineContext& context, const NodeId& object);
    StateMachine(const StateMachine&) = delete;
    StateMachine& operator=(const StateMachine&) = delete;
    ~StateMachine();

    [[nodiscard]] const NodeId& object() const { return object_; }
    [[nodiscard]] std::span<const MachineState> states() const { return states_; }
    [[nodiscard]] std::span<const MachineTransition> transitions() const { return transitions_; }
    /// Null while the machine is not active.
    [[nodiscard]] const MachineState* current() const;
    /// Null before the first transition.
    [[nodiscard]] const MachineTransition* last_transition() const;

    /// Makes the machine active in its initial state. Bad_InvalidState if it is active already or
    /// the type has no initial state, Bad_StateNotActive for a sub-machine of another state than
    /// the current one.
    Result<void> activate();
    /// Makes the machine and its sub-machines inactive.
    void deactivate();

    /// Goes to the state with this BrowseName by the transition that leads there, and raises the
    /// events of its effects. Going to the same state again needs a transition too. An inactive
    /// machine becomes active without a transition. Bad_NotFound if there is no such state,
    /// Bad_InvalidState if it is not available or no transition leads there from the current one,
    /// Bad_StateNotActive as for activate.
    Result<void> set_state(std::string_view state, DateTime time);
    /// Takes the transition with this BrowseName, if several lead to one state.
    Result<void> take(std::string_view transition, DateTime time);
    /// Takes the transition from the current state whose cause is this Method.
    Result<void> call(const NodeId& method, DateTime time);

    /// Sets the states that this instance uses, by BrowseName; the transitions between them are the
    /// available ones. Bad_NotFound for an unknown state, Bad_InvalidState if the current one is
    /// not among them.
    Result<void> set_available_states(std::span<const std::string_view> states);

    /// Returns the sub-machine with this BrowseName, null if there is none. Valid as long as the
    /// machine.
    [[nodiscard]] StateMachine* sub_machine(std::string_view name);

private:
    /// A machine below some of the states.
    struct SubMachine {
        QualifiedName browse_name;
        std::vector<std::size_t> states;
        std::unique_ptr<StateMachine> machine;
    };
    /// A Variable of the instance and its handle in `memory`.
    struct Slot {
        bool is_there{false};
        std::uint64_t handle{0};
    };
    /// The Variables of CurrentState or LastTransition.
    struct Slots {
        Slot value;
        Slot id;
        Slot name;
        Slot number;
        Slot effective_name;
        Slot time;
        Slot effective_time;
    };

    explicit StateMachine(const StateMachineContext& context) : context_{context} {}
    [[nodiscard]] static Result<std::unique_ptr<StateMachine>>
    attach(const StateMachineContext& context, model::NodeIndex object, std::size_t depth);
    [[nodiscard]] Result<void> attach_sub_machines(model::NodeIndex object, std::size_t depth);
    void take_over();
    void take_variables(model::NodeIndex object);
    [[nodiscard]] Slot take_variable(model::NodeIndex object, std::string_view path);
    [[nodiscard]] Slots take_variables(model::NodeIndex object, const char* name);
    void set(const Slot& slot, Variant value, StatusCode status = {});
    void enter(std::size_t state);
    void follow(const MachineTransition& transition, DateTime time);
    void show_state();
    void show_transition(DateTime time);
    void show_no_transition();
    void show_effective_names();
    void show_available();
    void show_inactive(const Slots& slots);
    [[nodiscard]] bool may_be_active() const;
    [[nodiscard]] bool is_available(const MachineTransition& transition) const;
    [[nodiscard]] Result<void> try_transition(const MachineTransition& transition, DateTime time);
    void raise(const MachineTransition& transition, DateTime time);
    void raise(const MachineTransition& transition, const NodeId& event_type, DateTime time);
    [[nodiscard]] std::optional<std::size_t> find_state(std::string_view name) const;
    [[nodiscard]] LocalizedText effective_name() const;

    StateMachineContext context_;
    NodeId object_;
    /// The machine that this one is a sub-machine of.
    StateMachine* parent_{nullptr};
    String source_name_;
    std::vector<MachineState> states_;
    std::vector<MachineTransition> transitions_;
    std::vector<SubMachine> sub_machines_;
    std::optional<std::size_t> current_;
    std::optional<std::size_t> last_;
    Slots state_slots_;
    Slots transition_slots_;
    Slot available_states_;
    Slot available_transitions_;
};

} // namespace busbar::server

#include <catch2/catch.hpp>

#include <string>

#include <busbar/model/instance.hpp>
#include <busbar/server/state_machine.hpp>

namespace state_machine_test {

using namespace busbar;
using namespace busbar::server;
using model::NewNode;
using model::no_node;
using model::NodeIndex;

namespace {

class TestClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override { return DateTime::from_unix_seconds(1000); }
};

const DateTime time_of_change = DateTime::from_unix_seconds(500);

/// A type as PackML has them: Running has a machine of its own.
struct MachineFixture {
    TestClock clock;
    model::AddressSpace space;
    MemorySource memory{clock};
    EventQueue events{clock, nullptr, 8};
    std::uint16_t ns{space.add_namespace("urn:machine").value()};

    [[nodiscard]] NewNode named(const std::string& id, NodeIndex parent) const
    {
        NewNode node;
        node.id = NodeId{ns, String{id}};
        node.browse_name = QualifiedName{ns, id.substr(id.rfind('.') + 1)};
        node.parent = parent;
        return node;
    }
    NodeIndex add_type(const char* name)
    {
        const NodeIndex base = space.find(id::FiniteStateMachineType);
        return space.add_object_type(named(name, base)).value();
    }
    void add_number(const std::string& owner, NodeIndex node, const char* name,
                    std::uint32_t number)
    {
        NewNode property = named(owner + '.' + name, node);
        property.browse_name.namespace_index = 0;
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::UInt32};
        variable.value = number;
        REQUIRE(space.add_property(property, variable));
    }
    NodeIndex add_state(NodeIndex type, const std::string& id, std::uint32_t number,
                        bool is_initial = false)
    {
        const NodeId kind{0, is_initial ? id::InitialStateType : id::StateType};
        const NodeIndex state = space.add_object(named(id, type), {kind, 0}).value();
        add_number(id, state, "StateNumber", number);
        return state;
    }
    void add_transition(NodeIndex type, const std::string& id, NodeIndex from, NodeIndex to,
                        bool has_effect = true)
    {
        const NodeIndex node =
            space.add_object(named(id, type), {NodeId{0, id::TransitionType}, 0}).value();
        add_number(id, node, "TransitionNumber", 12);
        REQUIRE(space.add_reference(node, NodeId{0, id::FromState}, from));
        REQUIRE(space.add_reference(node, NodeId{0, id::ToState}, to));
        if (has_effect) {
            REQUIRE(space.add_reference(node, NodeId{0, id::HasEffect},
                                        space.find(id::TransitionEventType)));
        }
    }
    /// MachineType, and its Object "Machine".
    NodeId add_machine()
    {
        const NodeIndex inner = add_type("InnerType");
        const NodeIndex slow = add_state(inner, "InnerType.Slow", 1, true);
        const NodeIndex fast = add_state(inner, "InnerType.Fast", 2);
        add_transition(inner, "InnerType.SlowToFast", slow, fast);

        const NodeIndex type = add_type("MachineType");
        const NodeIndex stopped = add_state(type, "MachineType.Stopped", 1, true);
        const NodeIndex running = add_state(type, "MachineType.Running", 2);
        add_state(type, "MachineType.Lost", 3);
        add_transition(type, "MachineType.StoppedToRunning", stopped, running);
        add_transition(type, "MachineType.RunningToStopped", running, stopped);
        const NodeIndex speed =
            space.add_object(named("MachineType.Speed", type), {space.node_id(inner), 0}).value();
        REQUIRE(space.add_reference(speed, NodeId{0, id::HasModellingRule},
                                    space.find(id::ModellingRule_Mandatory)));
        REQUIRE(space.add_reference(running, NodeId{0, id::HasSubStateMachine}, speed));
        return instantiate(type);
    }
    NodeId instantiate(NodeIndex type)
    {
        model::InstanceOptions options;
        options.all_optional = true;
        const NewNode node = named("Machine", space.find(id::ObjectsFolder));
        const auto made = model::instantiate(space, node, type, options);
        REQUIRE(made);
        return space.node_id(*made);
    }
    [[nodiscard]] StateMachineContext context() { return {&space, &memory, 0, &events, {}}; }
    std::unique_ptr<StateMachine> attach(const NodeId& object)
    {
        auto machine = StateMachine::attach(context(), object);
        REQUIRE(machine);
        return std::move(*machine);
    }

    /// What a client reads at that path below the machine.
    [[nodiscard]] const DataValue& read(const char* path)
    {
        const NodeIndex node = model::find_by_path(space, space.find(NodeId{ns, "Machine"}), path);
        INFO(path);
        REQUIRE(node != no_node);
        REQUIRE(space.variable(node).source == 0);
        return memory.get(space.variable(node).handle);
    }
    [[nodiscard]] std::string text(const char* path)
    {
        return read(path).value.value_or<LocalizedText>(LocalizedText{}).text.str();
    }
    [[nodiscard]] NodeId node_id(const char* path)
    {
        return read(path).value.value_or<NodeId>(NodeId{});
    }
    [[nodiscard]] std::vector<Event> raised()
    {
        std::vector<Event> all;
        events.begin();
        for (Event event; events.next(event);) {
            all.push_back(event);
        }
        return all;
    }
};

StatusCode status_of(const Result<void>& result)
{
    return result ? status::Good : result.error();
}

} // namespace

TEST_CASE_METHOD(MachineFixture, "A state machine shows where it is and how it came there",
                 "[unit:Base Info State Machine Instance]"
                 "[unit:Base Info Finite State Machine Instance]")
{
    const auto machine = attach(add_machine());
    CHECK(machine->states().size() == 3);
    CHECK(machine->transitions().size() == 2);
    CHECK(machine->current() == nullptr);
    CHECK(read("CurrentState").status == status::Bad_StateNotActive);
    CHECK(read("LastTransition/Id").status == status::Bad_StateNotActive);

    REQUIRE(machine->activate());
    CHECK(text("CurrentState") == "Stopped");
    CHECK(read("CurrentState").status.is_good());
    CHECK(node_id("LastTransition/Id").is_null());
    CHECK(machine->last_transition() == nullptr);
    CHECK(status_of(machine->activate()) == status::Bad_InvalidState);

    REQUIRE(machine->set_state("Running", time_of_change));
    CHECK(machine->current()->number == 2);
    CHECK(text("CurrentState") == "Running");
    CHECK(node_id("CurrentState/Id") == NodeId{ns, "MachineType.Running"});
    CHECK(read("CurrentState/Number").value == Variant{std::uint32_t{2}});
    CHECK(read("CurrentState/Name").value == Variant{QualifiedName{ns, "Running"}});
    CHECK(text("LastTransition") == "StoppedToRunning");
    CHECK(node_id("LastTransition/Id") == NodeId{ns, "MachineType.StoppedToRunning"});
    CHECK(read("LastTransition/Number").value == Variant{std::uint32_t{12}});
    CHECK(read("LastTransition/TransitionTime").value == Variant{time_of_change});

    machine->deactivate();
    CHECK(read("CurrentState").status == status::Bad_StateNotActive);
}

TEST_CASE_METHOD(MachineFixture, "A transition raises its event")
{
    const auto machine = attach(add_machine());
    REQUIRE(machine->activate());
    CHECK(raised().empty());
    REQUIRE(machine->take("StoppedToRunning", time_of_change));
    const auto events_raised = raised();
    REQUIRE(events_raised.size() == 1);
    const Event& event = events_raised[0];
    CHECK(event.event_type.is(id::TransitionEventType));
    CHECK(event.source_node == NodeId{ns, "Machine"});
    CHECK(event.source_name == "Machine");
    CHECK(event.time == time_of_change);
    const auto field = [&](std::vector<QualifiedName> path) {
        for (const EventField& each : event.fields) {
            if (each.path == path) {
                return each.value;
            }
        }
        return Variant{};
    };
    CHECK(field({{0, "Transition"}}) == Variant{LocalizedText{"StoppedToRunning"}});
    CHECK(field({{0, "FromState"}}) == Variant{LocalizedText{"Stopped"}});
    CHECK(field({{0, "ToState"}}) == Variant{LocalizedText{"Running"}});
    CHECK(field({{0, "ToState"}, {0, "Id"}}) == Variant{NodeId{ns, "MachineType.Running"}});
}

TEST_CASE_METHOD(MachineFixture, "A transition without effect raises what the application says")
{
    const NodeIndex type = add_type("QuietType");
    const NodeIndex a = add_state(type, "QuietType.A", 1, true);
    const NodeIndex b = add_state(type, "QuietType.B", 2);
    add_transition(type, "QuietType.AToB", a, b, false);
    StateMachineContext with = context();
    SECTION("nothing") {}
    SECTION("an event")
    {
        with.default_event_type = NodeId{0, id::TransitionEventType};
    }
    const auto machine = StateMachine::attach(with, instantiate(type));
    REQUIRE(machine);
    REQUIRE((*machine)->activate());
    REQUIRE((*machine)->set_state("B", time_of_change));
    const auto events_raised = raised();
    REQUIRE(events_raised.size() == (with.default_event_type.is_null() ? 0 : 1));
    for (const Event& event : events_raised) {
        CHECK(event.event_type == with.default_event_type);
    }
}

TEST_CASE_METHOD(MachineFixture, "States that no transition leads to are refused")
{
    const auto machine = attach(add_machine());
    REQUIRE(machine->activate());
    CHECK(status_of(machine->set_state("Nowhere", time_of_change)) == status::Bad_NotFound);
    CHECK(status_of(machine->set_state("Lost", time_of_change)) == status::Bad_InvalidState);
    CHECK(status_of(machine->set_state("Stopped", time_of_change)) == status::Bad_InvalidState);
    CHECK(status_of(machine->take("RunningToStopped", time_of_change)) == status::Bad_InvalidState);
    CHECK(status_of(machine->take("Nothing", time_of_change)) == status::Bad_NotFound);
    CHECK(text("CurrentState") == "Stopped");
    CHECK(raised().empty());
}

TEST_CASE_METHOD(MachineFixture, "Sub-machines are active in their state only")
{
    const auto machine = attach(add_machine());
    StateMachine* const speed = machine->sub_machine("Speed");
    REQUIRE(speed != nullptr);
    CHECK(machine->sub_machine("Other") == nullptr);
    REQUIRE(machine->activate());
    CHECK(read("Speed/CurrentState").status == status::Bad_StateNotActive);
    CHECK(status_of(speed->activate()) == status::Bad_StateNotActive);
    CHECK(status_of(speed->set_state("Fast", time_of_change)) == status::Bad_StateNotActive);
    CHECK(text("CurrentState/EffectiveDisplayName") == "Stopped");

    REQUIRE(machine->set_state("Running", time_of_change));
    CHECK(text("Speed/CurrentState") == "Slow");
    CHECK(text("CurrentState/EffectiveDisplayName") == "Running/Slow");
    REQUIRE(speed->set_state("Fast", time_of_change));
    CHECK(text("CurrentState/EffectiveDisplayName") == "Running/Fast");
    CHECK(raised().size() == 2);

    REQUIRE(machine->set_state("Stopped", time_of_change));
    CHECK(speed->current() == nullptr);
    CHECK(read("Speed/CurrentState").status == status::Bad_StateNotActive);
}

TEST_CASE_METHOD(MachineFixture, "An instance may have part of the states",
                 "[unit:Base Info Available States and Transitions]")
{
    const auto machine = attach(add_machine());
    CHECK(read("AvailableStates").value.array_size() == 3);
    CHECK(read("AvailableTransitions").value.array_size() == 2);
    const std::string_view two[] = {"Stopped", "Lost"};
    REQUIRE(machine->activate());
    REQUIRE(machine->set_available_states(two));
    CHECK(read("AvailableStates").value.array_size() == 2);
    CHECK(read("AvailableTransitions").value.array_size() == 0);
    CHECK(status_of(machine->set_state("Running", time_of_change)) == status::Bad_InvalidState);
    const std::string_view none[] = {"Lost"};
    CHECK(status_of(machine->set_available_states(none)) == status::Bad_InvalidState);
    const std::string_view unknown[] = {"Stopped", "Missing"};
    CHECK(status_of(machine->set_available_states(unknown)) == status::Bad_NotFound);
}

TEST_CASE_METHOD(MachineFixture, "Methods cause the transitions of a program")
{
    const NodeIndex type = space.find(id::ProgramStateMachineType);
    const auto machine = attach(instantiate(type));
    CHECK(machine->states().size() == 4);
    CHECK(machine->transitions().size() == 9);
    REQUIRE(machine->set_state("Ready", time_of_change));
    const NodeId start{0, id::ProgramStateMachineType_Start};
    REQUIRE(machine->call(start, time_of_change));
    CHECK(text("CurrentState") == "Running");
    CHECK(status_of(machine->call(start, time_of_change)) == status::Bad_InvalidState);
    const auto events_raised = raised();
    REQUIRE(events_raised.size() == 1);
    CHECK(events_raised[0].event_type.is(id::ProgramTransitionEventType));
}

TEST_CASE_METHOD(MachineFixture, "What is no state machine is refused")
{
    const auto status_for = [&](const NodeId& object) {
        const auto machine = StateMachine::attach(context(), object);
        return machine ? status::Good : machine.error();
    };
    CHECK(status_for(NodeId{0, id::Server}) == status::Bad_TypeDefinitionInvalid);
    CHECK(status_for(NodeId{ns, "Nothing"}) == status::Bad_TypeDefinitionInvalid);
    const NodeIndex type = add_type("BadType");
    SECTION("no states") {}
    SECTION("a transition that leads nowhere")
    {
        add_state(type, "BadType.A", 1);
        REQUIRE(space.add_object(named("BadType.T", type), {NodeId{0, id::TransitionType}, 0}));
    }
    const NodeId object = instantiate(type);
    CHECK(status_for(object) == status::Bad_TypeDefinitionInvalid);
    const NodeIndex state = model::find_by_path(space, space.find(object), "CurrentState");
    CHECK(space.variable(state).source == model::no_source);
}

} // namespace state_machine_test

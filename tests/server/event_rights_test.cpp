#include <catch2/catch.hpp>

#include "event_item_fixture.hpp"

namespace event_rights_test {

// Fields of events that a user may not read (Part 4, 7.22.3).

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using enum FilterOperator;

namespace {

/// An event type "Batch" with the Properties "Recipe" and "Count" and the Variable "Mixer" that has
/// a "Speed"; users of two kinds subscribe to the Server object.
struct RightsFixture : EventFixture {
    RightsFixture()
    {
        type = space().add_object_type(named("Batch", space().find(id::BaseEventType))).value();
        recipe = add_text("Recipe", type);
        count = add_text("Count", type);
        mixer = add_text("Mixer", type);
        speed = add_text("Speed", mixer);
        heir = space().add_object_type(named("Heir", type)).value();
    }
    [[nodiscard]] model::AddressSpace& space() { return server.address_space(); }
    [[nodiscard]] static model::NewNode named(const char* name, model::NodeIndex parent)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = parent;
        return node;
    }
    model::NodeIndex add_text(const char* name, model::NodeIndex parent)
    {
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::String};
        auto node = named(name, parent);
        node.reference_type = NodeId{0, id::HasComponent};
        return space().add_variable(node, variable).value();
    }
    /// The values of the node are for administrators.
    void hide(model::NodeIndex node)
    {
        constexpr auto browse = static_cast<std::uint32_t>(PermissionType::Browse);
        constexpr auto read = static_cast<std::uint32_t>(PermissionType::Read);
        model::NodeAccess access;
        access.role_permissions = {
            {NodeId{0, id::WellKnownRole_Anonymous}, PermissionType{browse}},
            {NodeId{0, id::WellKnownRole_SecurityAdmin}, PermissionType{browse | read}}};
        space().set_node_access(node, access);
    }
    [[nodiscard]] static SimpleAttributeOperand own(std::initializer_list<QualifiedName> path)
    {
        return field(path, NodeId{1, "Batch"});
    }
    [[nodiscard]] static EventFilter all_fields()
    {
        EventFilter filter = selecting({"Message"});
        filter.select_clauses.push_back(own({{1, "Recipe"}}));
        filter.select_clauses.push_back(own({{1, "Count"}}));
        filter.select_clauses.push_back(own({{1, "Mixer"}, {1, "Speed"}}));
        return filter;
    }
    std::uint32_t watch(TestClient& who, const EventFilter& filter)
    {
        const std::uint32_t subscription = subscribe(who);
        REQUIRE(monitor(who, subscription, event_request(filter)).status_code == status::Good);
        return subscription;
    }
    void mix(const char* event_type = "Batch")
    {
        server::Event event;
        event.event_type = NodeId{1, event_type};
        event.source_node = NodeId{0, id::Server};
        event.message = LocalizedText{"mixed"};
        event.set({1, "Recipe"}, "two eggs");
        event.set({1, "Count"}, "7");
        event.fields.push_back(
            {{QualifiedName{1, "Mixer"}, QualifiedName{1, "Speed"}}, Variant{"fast"}});
        REQUIRE(server.raise_event(std::move(event)));
        server.handle_completions(now);
    }
    /// The fields behind the message of the only event that comes.
    std::vector<Variant> next_fields(TestClient& to)
    {
        const auto events = next_events(to);
        REQUIRE(events.size() == 1);
        const auto& fields = events[0].event_fields;
        REQUIRE(fields.size() == 4);
        CHECK(fields[0] == Variant{LocalizedText{"mixed"}});
        return {fields.begin() + 1, fields.end()};
    }

    using Fields = std::vector<Variant>;
    const Variant denied{StatusCode{status::Bad_UserAccessDenied}};
    model::NodeIndex type, recipe, count, mixer, speed, heir;
    TestClient worker{log_in_as("operator")};
    TestClient admin{log_in_as("admin")};
};

} // namespace

TEST_CASE_METHOD(RightsFixture, "a field of an event is for those who may read its declaration")
{
    hide(recipe);
    watch(worker, all_fields());
    watch(admin, all_fields());
    mix();
    CHECK(next_fields(worker) == Fields{denied, "7", "fast"});
    CHECK(next_fields(admin) == Fields{"two eggs", "7", "fast"});
    // As it is inherited, so it is kept.
    mix("Heir");
    CHECK(next_fields(worker) == Fields{denied, "7", "fast"});
    CHECK(next_fields(admin) == Fields{"two eggs", "7", "fast"});
}

TEST_CASE_METHOD(RightsFixture, "permissions of fields may come and go while items are there")
{
    watch(worker, all_fields());
    mix();
    CHECK(next_fields(worker) == Fields{"two eggs", "7", "fast"});
    hide(speed);
    mix();
    CHECK(next_fields(worker) == Fields{"two eggs", "7", denied});
    space().set_node_access(speed, {});
    const RolePermissionType events_only{NodeId{0, id::WellKnownRole_Anonymous},
                                         PermissionType::ReceiveEvents};
    space().set_namespace_permissions(1, Array<RolePermissionType>{events_only});
    mix();
    CHECK(next_fields(worker) == Fields{denied, denied, denied});
    space().set_namespace_permissions(1, {});
    mix();
    CHECK(next_fields(worker) == Fields{"two eggs", "7", "fast"});
}

TEST_CASE_METHOD(RightsFixture, "a field of every event may be denied too")
{
    const model::NodeIndex severity = space().find(id::BaseEventType_Severity);
    if (severity == model::no_node) {
        return; // a small namespace 0
    }
    hide(severity);
    EventFilter filter = selecting({"Message", "Severity"});
    watch(worker, filter);
    raise("low", 3);
    const auto events = next_events(worker);
    REQUIRE(events.size() == 1);
    CHECK(events[0].event_fields[0] == Variant{LocalizedText{"low"}});
    CHECK(events[0].event_fields[1] == denied);
}

TEST_CASE_METHOD(RightsFixture, "a whereClause tells nothing of a field that is denied")
{
    hide(recipe);
    EventFilter filter = all_fields();
    where(filter, Equals, {of(own({{1, "Recipe"}})), literal("two eggs")});
    watch(worker, filter);
    watch(admin, filter);
    mix();
    CHECK(next_events(worker).empty());
    CHECK(next_events(admin).size() == 1);
    // As for an event without the field.
    EventFilter without = all_fields();
    where(without, IsNull, {of(own({{1, "Recipe"}}))});
    TestClient other = log_in_as("operator");
    watch(other, without);
    mix();
    CHECK(next_events(other).size() == 1);
}

TEST_CASE_METHOD(RightsFixture, "what waits with a field that is not for all is no other user's")
{
    hide(recipe);
    watch(admin, all_fields());
    mix();
    raise("anything"); // chosen by the same filter
    REQUIRE(admin.activate(admin.user("operator", "operator-secret")) == status::Good);
    CHECK(next_messages(admin) == std::vector<std::string>{"Events were lost"});
    mix();
    CHECK(next_fields(admin) == Fields{denied, "7", "fast"});

    // Nothing is lost where there is nothing to hide.
    watch(worker, selecting({"Message"}));
    mix();
    REQUIRE(worker.activate(worker.user("admin", "admin-secret")) == status::Good);
    CHECK(next_messages(worker) == std::vector<std::string>{"mixed"});
}

} // namespace event_rights_test

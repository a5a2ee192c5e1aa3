#include <catch2/catch.hpp>

#include <algorithm>

#include "diagnostics_fixture.hpp"

namespace session_nodes_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::uint32_t sessions_array =
    id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionDiagnosticsArray;

} // namespace

TEST_CASE_METHOD(DiagnosticsFixture, "each activated session has an Object, as long as it lives")
{
    TestClient client = log_in();
    TestClient other = connect();
    REQUIRE(other.create_session());
    CHECK(session_objects(client).size() == 1); // the other one is not activated yet
    REQUIRE(other.activate(TestClient::anonymous()) == status::Good);
    const auto objects = session_objects(client); // of the same name, which Objects may not have
    REQUIRE(objects.size() == 2);
    CHECK(objects[0].browse_name != objects[1].browse_name);
    CHECK(objects[0].browse_name.name == "test");
    CHECK(objects[0].type_definition.node_id == NodeId{0, id::SessionDiagnosticsObjectType});
    const NodeId own = objects[0].node_id.node_id;
    const auto sessions = array<SessionDiagnosticsDataType>(client, sessions_array);
    CHECK(std::count_if(sessions.begin(), sessions.end(),
                        [&](const auto& session) { return session.session_id == own; }) == 1);

    const auto parts = children(client, own); // of which only administrators see all
    REQUIRE(parts.size() == 2);
    CHECK(parts[0].browse_name == QualifiedName{0, "SessionDiagnostics"});
    CHECK(parts[1].browse_name == QualifiedName{0, "SubscriptionDiagnosticsArray"});
    const auto fields = children(client, parts[0].node_id.node_id);
    CHECK(fields.size() == 43);
    for (const ReferenceDescription& field : fields) {
        const DataValue value = read(client, field.node_id.node_id);
        CHECK(value.status == status::Good);
        if (field.browse_name.name == "SessionName") {
            CHECK(value.value == Variant{"test"});
        }
    }
    const DataValue all = read(client, parts[0].node_id.node_id);
    const auto* object = all.value.get_if<ExtensionObject>();
    REQUIRE(object != nullptr);
    REQUIRE(object->get_if<SessionDiagnosticsDataType>() != nullptr);
    CHECK(object->get_if<SessionDiagnosticsDataType>()->session_id == own);

    subscribe(other);
    const auto id = subscribe(client);
    const DataValue subscriptions = read(client, parts[1].node_id.node_id);
    const auto* array_of = subscriptions.value.array_if<ExtensionObject>();
    REQUIRE(array_of != nullptr);
    REQUIRE(array_of->size() == 1);
    CHECK((*array_of)[0].get_if<SubscriptionDiagnosticsDataType>()->subscription_id == id);
    {
        TestClient user = log_in_admin();
        const auto all_parts = children(user, own);
        REQUIRE(all_parts.size() == 3);
        CHECK(all_parts[1].browse_name == QualifiedName{0, "SessionSecurityDiagnostics"});
        CHECK(children(user, all_parts[1].node_id.node_id).size() == 9);
        CHECK(children(client, all_parts[1].node_id.node_id).empty());
        CHECK(read(client, all_parts[1].node_id.node_id).status == status::Bad_NodeIdUnknown);
        const DataValue security = read(user, all_parts[1].node_id.node_id);
        CHECK(security.status == status::Good);
        CHECK(session_objects(client).size() == 3);
        CHECK(enable(user, false) == status::Good);
        CHECK(session_objects(client).empty());
        CHECK(read(client, parts[0].node_id.node_id).status == status::Bad_NodeIdUnknown);
        CHECK(enable(user, true) == status::Good);
        CHECK(session_objects(client).size() == 3);
        CHECK(user.close_session() == status::Good);
    }
    CHECK(session_objects(client).size() == 2);
    advance(61s);
    TestClient later = log_in();
    CHECK(session_objects(later).size() == 1);
}

namespace {

/// The arrays of the diagnostics, of two users' sessions.
struct ArraysFixture : DiagnosticsFixture {
    static std::vector<ReferenceDescription> elements(TestClient& reader, const NodeId& array)
    {
        auto all = children(reader, array);
        std::sort(all.begin(), all.end(),
                  [](const auto& a, const auto& b) { return a.browse_name < b.browse_name; });
        return all;
    }
    static std::vector<ReferenceDescription> elements(TestClient& reader, std::uint32_t array)
    {
        return elements(reader, NodeId{0, array});
    }
    /// Those of the SubscriptionDiagnosticsArray of the user's session.
    std::vector<ReferenceDescription> elements_of(const char* user)
    {
        for (const ReferenceDescription& session : session_objects(admin)) {
            const auto parts = children(admin, session.node_id.node_id);
            for (const ReferenceDescription& part : children(admin, parts[1].node_id.node_id)) {
                if (part.browse_name.name == "ClientUserIdOfSession" &&
                    read(admin, part.node_id.node_id).value == Variant{user}) {
                    return elements(admin, parts[2].node_id.node_id);
                }
            }
        }
        return {};
    }

    TestClient admin{log_in_admin()};
    TestClient client{log_in_as("operator")};
};

constexpr std::uint32_t security_array =
    id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionSecurityDiagnosticsArray;
constexpr std::uint32_t subscriptions_array =
    id::Server_ServerDiagnostics_SubscriptionDiagnosticsArray;

} // namespace

TEST_CASE_METHOD(ArraysFixture, "the arrays have their elements as Variables")
{
    const auto sessions = elements(admin, sessions_array);
    REQUIRE(sessions.size() == 2);
    for (const ReferenceDescription& each : sessions) {
        CHECK(each.browse_name == QualifiedName{0, "SessionDiagnostics"});
        CHECK(each.type_definition.node_id == NodeId{0, id::SessionDiagnosticsVariableType});
        CHECK(read(admin, each.node_id.node_id).status == status::Good);
    }
    CHECK(elements(admin, security_array).size() == 2);
    CHECK(elements(client, security_array).empty());

    const std::uint32_t first = subscribe(client);
    const std::uint32_t second = subscribe(client);
    const auto subscriptions = elements(client, subscriptions_array);
    REQUIRE(subscriptions.size() == 2);
    const NodeId element = subscriptions[first < second ? 0 : 1].node_id.node_id;
    const auto fields = children(client, element);
    CHECK(fields.size() == 31);
    for (const ReferenceDescription& field : fields) {
        const DataValue value = read(client, field.node_id.node_id);
        CHECK(value.status == status::Good);
        CHECK_FALSE(value.value.is_null());
        if (field.browse_name.name == "SubscriptionId") {
            CHECK(value.value == Variant{first});
        }
    }
    const DataValue whole = read(client, element);
    const auto* const object = whole.value.get_if<ExtensionObject>();
    REQUIRE(object != nullptr);
    CHECK(object->get_if<SubscriptionDiagnosticsDataType>()->subscription_id == first);
}

TEST_CASE_METHOD(ArraysFixture, "a Subscription is in the array of whichever session it has")
{
    const std::uint32_t first = subscribe(client);
    const std::uint32_t second = subscribe(client);
    CHECK(elements_of("operator").size() == 2);
    CHECK(elements_of("admin").empty());
    REQUIRE(remove(client, second) == status::Good);
    REQUIRE(elements_of("operator").size() == 1);
    const NodeId element = elements_of("operator")[0].node_id.node_id;

    TestClient heir = log_in_as("operator");
    CloseSessionRequest close;
    close.delete_subscriptions = false;
    REQUIRE(client.status_of<CloseSessionResponse>(close) == status::Good);
    CHECK(read(admin, element).status == status::Good); // it lives on without a session
    CHECK(elements_of("operator").empty());
    REQUIRE(transfer(heir, first).status_code == status::Good);
    REQUIRE(elements_of("operator").size() == 1);
    CHECK(elements_of("operator")[0].node_id.node_id == element);

    REQUIRE(enable(admin, false) == status::Good);
    CHECK(elements(admin, subscriptions_array).empty());
    CHECK(elements(admin, sessions_array).empty());
    REQUIRE(enable(admin, true) == status::Good);
    CHECK(elements(admin, subscriptions_array).size() == 1);
    CHECK(elements_of("operator").size() == 1);
    REQUIRE(remove(heir, first) == status::Good);
    CHECK(elements(admin, subscriptions_array).empty());
    CHECK(read(admin, element).status == status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(DiagnosticsFixture, "fields of diagnostics are nodes once they are looked for")
{
    TestClient client = log_in();
    const std::uint32_t id = subscribe(client);
    const auto parts = children(client, session_objects(client)[0].node_id.node_id);
    REQUIRE(parts.size() == 2);
    const auto subscriptions = children(client, parts[1].node_id.node_id);
    REQUIRE(subscriptions.size() == 1);
    const model::AddressSpace& space = server.address_space();
    const auto has_nodes_below = [&](const ReferenceDescription& part) {
        model::ReferenceCursor cursor = space.references(space.find(part.node_id.node_id));
        bool has_child = false;
        while (const auto reference = cursor.next()) {
            has_child = has_child || (reference->is_forward &&
                                      space.is_subtype_of(reference->type, id::HasComponent));
        }
        return has_child;
    };
    CHECK_FALSE(has_nodes_below(parts[0]));
    CHECK_FALSE(has_nodes_below(subscriptions[0]));

    const auto follow = [&](const ReferenceDescription& part, const char* name) {
        TranslateBrowsePathsToNodeIdsRequest request;
        request.browse_paths.resize(1);
        request.browse_paths[0].starting_node = part.node_id.node_id;
        RelativePathElement& element =
            request.browse_paths[0].relative_path.elements.emplace_back();
        element.reference_type_id = NodeId{0, id::HasComponent};
        element.target_name = QualifiedName{0, name};
        const auto response = client.call<TranslateBrowsePathsToNodeIdsResponse>(request);
        REQUIRE(response);
        REQUIRE(response->results[0].targets.size() == 1);
        return read(client, response->results[0].targets[0].target_id.node_id).value;
    };
    CHECK(follow(parts[0], "SessionName") == Variant{"test"});
    CHECK(has_nodes_below(parts[0]));
    CHECK_FALSE(has_nodes_below(subscriptions[0]));
    CHECK(children(client, parts[0].node_id.node_id).size() == 43);
    CHECK(follow(subscriptions[0], "SubscriptionId") == Variant{id});
    CHECK(children(client, subscriptions[0].node_id.node_id).size() == 31);
}

TEST_CASE_METHOD(DiagnosticsFixture, "a session's diagnostics can be monitored until it ends")
{
    TestClient client = log_in();
    TestClient other = log_in();
    const auto sessions = session_objects(client);
    REQUIRE(sessions.size() == 2);
    const auto parts = children(client, sessions[1].node_id.node_id);
    REQUIRE(parts.size() == 2);
    const auto id = subscribe(client);
    CHECK(monitor(client, id, item_request(parts[1].node_id.node_id)).status_code == status::Good);
    CHECK(next_data(client, 100ms).size() == 1);
    CHECK(next_data(client, 100ms).empty());
    subscribe(other);
    CHECK(next_data(client, 100ms).size() == 1);
    CHECK(other.close_session() == status::Good);
    const auto data = next_data(client, 100ms);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value.status == status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(DiagnosticsFixture, "a continuation point lives on when others connect and leave")
{
    TestClient client = log_in();
    BrowseRequest request;
    request.requested_max_references_per_node = 1;
    request.nodes_to_browse.resize(1);
    request.nodes_to_browse[0].node_id = NodeId{0, id::Server};
    const auto begun = client.call<BrowseResponse>(request);
    REQUIRE(begun);
    for (int round = 0; round < 10; ++round) {
        TestClient one = log_in();
        TestClient other = log_in();
        CHECK(one.close_session() == status::Good);
        CHECK(other.close_session() == status::Good);
    }
    BrowseNextRequest next;
    next.continuation_points = {begun->results[0].continuation_point};
    const auto gone_on = client.call<BrowseNextResponse>(next);
    REQUIRE(gone_on);
    CHECK(gone_on->results[0].status_code == status::Good);
    CHECK(gone_on->results[0].references.size() == 1);
}

} // namespace session_nodes_test

#include <catch2/catch.hpp>

#include <algorithm>

#include "diagnostics_fixture.hpp"

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

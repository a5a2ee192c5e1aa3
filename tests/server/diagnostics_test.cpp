#include <catch2/catch.hpp>

#include "diagnostics_fixture.hpp"

namespace diagnostics_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::uint32_t current_sessions =
    id::Server_ServerDiagnostics_ServerDiagnosticsSummary_CurrentSessionCount;
constexpr std::uint32_t all_sessions =
    id::Server_ServerDiagnostics_ServerDiagnosticsSummary_CumulatedSessionCount;
constexpr std::uint32_t sessions_array =
    id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionDiagnosticsArray;
constexpr std::uint32_t security_array =
    id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionSecurityDiagnosticsArray;

} // namespace

TEST_CASE_METHOD(DiagnosticsFixture, "the summary counts sessions, subscriptions and refusals",
                 "[unit:Base Info Diagnostics]")
{
    TestClient client = log_in();
    {
        TestClient other = log_in();
        CHECK(number(client, current_sessions) == 2);
        CHECK(other.close_session() == status::Good);
    }
    CHECK(number(client, current_sessions) == 1);
    CHECK(number(client, all_sessions) == 2);
    const auto first = subscribe(client);
    subscribe(client, subscription_request(200));
    subscribe(client, subscription_request(200));
    CHECK(remove(client, first) == status::Good);
    REQUIRE(client.call<ReadResponse>(ReadRequest{}).error() == status::Bad_NothingToDo);
    TestClient stranger = connect();
    CHECK(stranger.call<ReadResponse>(ReadRequest{}).error() == status::Bad_SessionIdInvalid);
    REQUIRE(stranger.create_session());
    AnonymousIdentityToken token;
    token.policy_id = "none of the server's";
    CHECK(stranger.activate(ExtensionObject::from(token)) == status::Bad_IdentityTokenInvalid);

    const DataValue value = read(client, id::Server_ServerDiagnostics_ServerDiagnosticsSummary);
    const auto* object = value.value.get_if<ExtensionObject>();
    REQUIRE(object != nullptr);
    const auto* summary = object->get_if<ServerDiagnosticsSummaryDataType>();
    REQUIRE(summary != nullptr);
    CHECK(summary->current_session_count == 2);
    CHECK(summary->cumulated_session_count == 3);
    CHECK(summary->current_subscription_count == 2);
    CHECK(summary->cumulated_subscription_count == 3);
    CHECK(summary->publishing_interval_count == 1);
    CHECK(summary->rejected_requests_count == 3);
    CHECK(summary->security_rejected_requests_count == 2);
    CHECK(summary->rejected_session_count == 1);
    CHECK(summary->session_timeout_count == 0);
    advance(2min, client);
    TestClient later = log_in();
    CHECK(number(later,
                 id::Server_ServerDiagnostics_ServerDiagnosticsSummary_SessionTimeoutCount) == 2);
}

TEST_CASE_METHOD(DiagnosticsFixture, "each session counts its requests",
                 "[unit:Base Info Diagnostics]")
{
    TestClient client = log_in();
    const auto id = subscribe(client);
    monitor(client, id, item_request(add_variable("level", 1)));
    REQUIRE_FALSE(client.call<ReadResponse>(ReadRequest{}));
    REQUIRE_FALSE(client.call<CreateMonitoredItemsResponse>(CreateMonitoredItemsRequest{}));
    wall_clock.time.ticks += 50;
    const auto sessions = array<SessionDiagnosticsDataType>(client, sessions_array);
    REQUIRE(sessions.size() == 1);
    const auto& session = sessions[0];
    CHECK(session.session_name == "test");
    CHECK(session.client_description.application_uri == "urn:busbar:test:client");
    CHECK(session.actual_session_timeout == 60'000);
    CHECK(session.client_last_contact_time == wall_clock.time);
    CHECK(session.client_connection_time.ticks == wall_clock.time.ticks - 50);
    CHECK(session.current_subscriptions_count == 1);
    CHECK(session.current_monitored_items_count == 1);
    CHECK(session.read_count.total_count == 2); // with this one
    CHECK(session.read_count.error_count == 1);
    CHECK(session.create_subscription_count.total_count == 1);
    CHECK(session.create_monitored_items_count.total_count == 2);
    CHECK(session.create_monitored_items_count.error_count == 1);
    CHECK(session.write_count.total_count == 0);
    CHECK(session.total_request_count.total_count == 6); // with ActivateSession
    CHECK(session.total_request_count.error_count == 2);
    CHECK(session.unauthorized_request_count == 0);

    const auto subscriptions = array<SubscriptionDiagnosticsDataType>(
        client, id::Server_ServerDiagnostics_SubscriptionDiagnosticsArray);
    REQUIRE(subscriptions.size() == 1);
    CHECK(subscriptions[0].subscription_id == id);
    CHECK(subscriptions[0].session_id == session.session_id);
    CHECK(subscriptions[0].publishing_interval == 100);
    CHECK(subscriptions[0].monitored_item_count == 1);
    CHECK(subscriptions[0].publishing_enabled);
    CHECK(subscriptions[0].next_sequence_number == 1);
}

TEST_CASE_METHOD(DiagnosticsFixture, "a session's name is a text, whatever its client says")
{
    struct Case {
        std::string sent;
        std::string shown; // empty: the session's id
    };
    for (const Case& each : {Case{"panel", "panel"}, Case{"", ""}, Case{"  ", ""},
                             Case{"\xe2\x80\xaepanel", "\\u202Epanel"},
                             Case{std::string(255, 'n') + "\xe6\xb0\xb4", std::string(255, 'n')}}) {
        INFO(each.shown);
        TestClient client = connect();
        auto request = client.create_request();
        request.session_name = String{each.sent};
        REQUIRE(client.create_session(request));
        REQUIRE(client.activate(TestClient::anonymous()) == status::Good);
        const auto sessions = array<SessionDiagnosticsDataType>(client, sessions_array);
        REQUIRE(sessions.size() == 1);
        const std::string_view name = sessions[0].session_name.view();
        CHECK((each.shown.empty() ? name.size() == 36 : name == each.shown));
        client.close_session();
    }
}

TEST_CASE_METHOD(DiagnosticsFixture, "a session is described as its client described itself")
{
    TestClient client = connect();
    auto request = client.create_request();
    request.client_description.product_uri = "urn:busbar:test:product";
    request.client_description.application_name = LocalizedText{"en", "panel"};
    request.client_description.application_type = ApplicationType::ClientAndServer;
    request.server_uri = "urn:busbar:test:server";
    request.session_name = String{std::string(5'000, 'n')};
    REQUIRE(client.create_session(request));
    REQUIRE(client.activate(TestClient::anonymous()) == status::Good);
    subscribe(client);
    for (int i = 0; i < 3; ++i) {
        publish(client);
    }
    const auto sessions = array<SessionDiagnosticsDataType>(client, sessions_array);
    REQUIRE(sessions.size() == 1);
    const auto& session = sessions[0];
    CHECK(session.client_description.application_uri == "urn:busbar:test:client");
    CHECK(session.client_description.product_uri == "urn:busbar:test:product");
    CHECK(session.client_description.application_name == LocalizedText{"en", "panel"});
    CHECK(session.client_description.application_type == ApplicationType::ClientAndServer);
    CHECK(session.server_uri == "urn:busbar:test:server");
    CHECK(session.endpoint_url == "opc.tcp://localhost:4840");
    CHECK(session.session_name.size() == 256);
    CHECK(session.current_publish_requests_in_queue == 3);
    CHECK(session.publish_count.total_count == 3);
}

TEST_CASE_METHOD(DiagnosticsFixture, "nobody reads a password in a session's EndpointUrl")
{
    const auto [given, shown] = GENERATE(table<const char*, const char*>({
        {"opc.tcp://joe:secret@localhost:4840/a@b", "opc.tcp://localhost:4840/a@b"},
        {"opc.tcp://joe@work:secret@localhost", "opc.tcp://localhost"},
        {"opc.tcp://localhost/joe@home", "opc.tcp://localhost/joe@home"},
        {"joe:secret@localhost", "localhost"},
        {"@", ""},
    }));
    TestClient client = connect();
    auto request = client.create_request();
    request.endpoint_url = given;
    REQUIRE(client.create_session(request));
    REQUIRE(client.activate(TestClient::anonymous()) == status::Good);
    const auto sessions = array<SessionDiagnosticsDataType>(client, sessions_array);
    REQUIRE(sessions.size() == 1);
    CHECK(sessions[0].endpoint_url.view() == shown);
}

TEST_CASE_METHOD(DiagnosticsFixture, "a Subscription counts what it does")
{
    TestClient client = log_in();
    const auto id = subscribe(client);
    const auto of_subscription = [&] {
        const auto all = array<SubscriptionDiagnosticsDataType>(
            client, id::Server_ServerDiagnostics_SubscriptionDiagnosticsArray);
        REQUIRE(all.size() == 1);
        return all[0];
    };
    auto item = item_request(add_variable("level", 1));
    item.requested_parameters.queue_size = 2;
    const auto made = monitor(client, id, item);
    item.monitoring_mode = MonitoringMode::Disabled;
    monitor(client, id, item);
    CHECK(of_subscription().disabled_monitored_item_count == 1);
    CHECK(of_subscription().monitored_item_count == 2);
    for (int i = 2; i < 6;
         ++i) { // no Publish request: the first cycle is late, the queue too short
        set(0, i);
        advance(50ms);
    }
    auto now_there = of_subscription();
    CHECK(now_there.late_publish_request_count == 1);
    CHECK(now_there.monitoring_queue_overflow_count == 3);
    CHECK(now_there.publish_request_count == 0);
    CHECK(now_there.current_lifetime_count < now_there.max_lifetime_count);

    CHECK(next_data(client, 100ms).size() == 2);
    now_there = of_subscription();
    CHECK(now_there.publish_request_count == 1);
    CHECK(now_there.data_change_notifications_count == 2);
    CHECK(now_there.notifications_count == 2);
    CHECK(now_there.event_notifications_count == 0);
    CHECK(now_there.unacknowledged_message_count == 1);
    CHECK(now_there.next_sequence_number == 2);
    CHECK(republish(client, id, 1));
    CHECK_FALSE(republish(client, id, 7));
    publish(client, {{id, 1}});
    advance(1s, client);
    now_there = of_subscription();
    CHECK(now_there.republish_request_count == 2);
    CHECK(now_there.republish_message_request_count == 2);
    CHECK(now_there.republish_message_count == 1);
    CHECK(now_there.unacknowledged_message_count == 0);
    CHECK(now_there.discarded_message_count == 0);
    CHECK(now_there.current_keep_alive_count == 1);

    CHECK(set_publishing(client, id, false) == status::Good);
    CHECK(set_publishing(client, id, false) == status::Good);
    CHECK(set_publishing(client, id, true) == status::Good);
    ModifySubscriptionRequest modify;
    modify.subscription_id = id;
    modify.requested_publishing_interval = 100;
    REQUIRE(client.call<ModifySubscriptionResponse>(modify));
    CHECK(set_mode(client, id, made.monitored_item_id, MonitoringMode::Disabled) == status::Good);
    now_there = of_subscription();
    CHECK(now_there.disable_count == 1);
    CHECK(now_there.enable_count == 1);
    CHECK(now_there.modify_count == 1);
    CHECK(now_there.disabled_monitored_item_count == 2);
}

TEST_CASE_METHOD(DiagnosticsFixture, "lost messages and transfers are counted")
{
    TestClient client = log_in_admin();
    const auto id = subscribe(client);
    monitor(client, id, item_request(add_variable("level", 0)));
    for (int i = 1; i <= 103; ++i) { // 100 are kept
        set(0, i);
        CHECK(next_data(client, 100ms).size() == 1);
    }
    TestClient other = log_in_admin();
    CHECK(transfer(other, id).status_code == status::Good);
    CHECK(transfer(other, id).status_code == status::Bad_NothingToDo);
    const auto all = array<SubscriptionDiagnosticsDataType>(
        other, id::Server_ServerDiagnostics_SubscriptionDiagnosticsArray);
    REQUIRE(all.size() == 1);
    CHECK(all[0].unacknowledged_message_count == 100);
    CHECK(all[0].discarded_message_count == 3);
    CHECK(all[0].transfer_request_count == 2);
    CHECK(all[0].transferred_to_same_client_count == 1);
    CHECK(all[0].transferred_to_alt_client_count == 0);
}

TEST_CASE("sampling intervals are counted where there are only a few",
          "[unit:Base Info Fixed SamplingInterval]")
{
    struct Fixture : DiagnosticsFixture {
        explicit Fixture(const server::SubscriptionLimits& limits) : DiagnosticsFixture{limits} {}
    };
    constexpr std::uint32_t node = id::Server_ServerDiagnostics_SamplingIntervalDiagnosticsArray;
    Fixture fixture{server::rd81opc96_subscriptions()};
    TestClient client = fixture.log_in();
    const auto id = fixture.subscribe(client);
    auto item = fixture.item_request(fixture.add_variable("level", 1));
    fixture.monitor(client, id, item);
    const auto second = fixture.monitor(client, id, item).monitored_item_id;
    item.requested_parameters.sampling_interval = 1'000;
    fixture.monitor(client, id, item);
    CHECK(fixture.set_mode(client, id, second, MonitoringMode::Disabled) == status::Good);
    using Entry = SamplingIntervalDiagnosticsDataType;
    CHECK(fixture.array<Entry>(client, node) ==
          std::vector<Entry>{{200, 2, 2, 1}, {1'000, 1, 1, 0}});
    DeleteMonitoredItemsRequest request;
    request.subscription_id = id;
    request.monitored_item_ids = {second};
    REQUIRE(client.call<DeleteMonitoredItemsResponse>(request));
    CHECK(fixture.array<Entry>(client, node) ==
          std::vector<Entry>{{200, 1, 2, 0}, {1'000, 1, 1, 0}});
    CHECK(fixture.remove(client, id) == status::Good);
    CHECK(fixture.array<Entry>(client, node).empty());

    Fixture any{SubscriptionFixture::small_limits()};
    TestClient free = any.log_in();
    any.monitor(free, any.subscribe(free), any.item_request(any.add_variable("level", 1)));
    CHECK(any.array<Entry>(free, node).empty());
}

TEST_CASE_METHOD(DiagnosticsFixture, "security diagnostics are for SecurityAdmin")
{
    // Whose RolePermissions lack Browse does not know of the node.
    TestClient anonymous = log_in();
    CHECK(read(anonymous, security_array).status == status::Bad_NodeIdUnknown);
    {
        TestClient overheard = log_in(setting("Basic256Sha256", MessageSecurityMode::Sign));
        CHECK(read(overheard, security_array).status == status::Bad_NodeIdUnknown);
        const auto id = subscribe(overheard);
        CHECK(monitor(overheard, id, item_request(NodeId{0, security_array})).status_code ==
              status::Bad_NodeIdUnknown);
        CHECK(overheard.close_session() == status::Good);
    }
    TestClient client = log_in_admin();
    const auto sessions = array<SessionSecurityDiagnosticsDataType>(client, security_array);
    REQUIRE(sessions.size() == 2);
    const auto& own = sessions[0].security_mode == MessageSecurityMode::SignAndEncrypt
                          ? sessions[0]
                          : sessions[1];
    CHECK(own.client_user_id_of_session == "admin");
    CHECK(own.authentication_mechanism == "UserName");
    CHECK(own.security_policy_uri.view().ends_with("#Basic256Sha256"));
    CHECK(own.client_certificate == ByteString{client_identity().certificates.front().der()});
    CHECK(array<SessionDiagnosticsDataType>(client, sessions_array).size() == 2);
}

TEST_CASE_METHOD(DiagnosticsFixture, "a session is its creator's, whoever has it later",
                 "[unit:Session Change User]")
{
    TestClient client = log_in_as("operator");
    REQUIRE(client.activate(client.user("admin", "admin-secret")) == status::Good);
    REQUIRE(client.activate(client.user("admin", "admin-secret")) == status::Good);
    const auto sessions = array<SessionSecurityDiagnosticsDataType>(client, security_array);
    REQUIRE(sessions.size() == 1);
    CHECK(sessions[0].client_user_id_of_session == "operator");
    CHECK(sessions[0].client_user_id_history == Array<String>{"operator", "admin"});
    for (int i = 0; i < 20; ++i) { // as many as there is room for
        REQUIRE(client.activate(client.user("operator", "operator-secret")) == status::Good);
        REQUIRE(client.activate(client.user("admin", "admin-secret")) == status::Good);
    }
    const auto later = array<SessionSecurityDiagnosticsDataType>(client, security_array);
    CHECK(later[0].client_user_id_of_session == "operator");
    CHECK(later[0].client_user_id_history.size() == 8);
    CHECK(later[0].client_user_id_history[7] == "admin");
}

TEST_CASE_METHOD(DiagnosticsFixture, "Views are counted")
{
    TestClient client = log_in();
    constexpr std::uint32_t views =
        id::Server_ServerDiagnostics_ServerDiagnosticsSummary_ServerViewCount;
    CHECK(number(client, views) == 0);
    auto& space = server.address_space();
    model::NewNode folder;
    folder.id = NodeId{1, "folder"};
    folder.browse_name = QualifiedName{1, "folder"};
    folder.parent = space.find(id::ViewsFolder);
    const auto below = space.add_folder(folder);
    REQUIRE(below);
    model::NewNode view = folder;
    view.id = NodeId{1, "view"};
    view.browse_name = QualifiedName{1, "view"};
    view.parent = *below;
    REQUIRE(space.add_view(view));
    CHECK(number(client, views) == 1);
}

TEST_CASE_METHOD(DiagnosticsFixture, "diagnostics are switched off and begin anew")
{
    TestClient reader = log_in();
    TestClient client = log_in_admin();
    constexpr std::uint32_t flag = id::Server_ServerDiagnostics_EnabledFlag;
    CHECK(read(reader, flag).value == Variant{true});
    CHECK(enable(reader, false) == status::Bad_UserAccessDenied);
    CHECK(number(reader, all_sessions) == 2);
    CHECK(enable(client, false) == status::Good);
    CHECK(read(reader, flag).value == Variant{false});
    for (const std::uint32_t node : {all_sessions, sessions_array, security_array,
                                     id::Server_ServerDiagnostics_ServerDiagnosticsSummary,
                                     id::Server_ServerDiagnostics_SubscriptionDiagnosticsArray}) {
        CHECK(read(client, node).status == status::Bad_NotReadable);
    }
    CHECK(enable(client, true) == status::Good);
    CHECK(number(reader, all_sessions) == 2); // no fewer than there are
    CHECK(number(reader, current_sessions) == 2);
    for (const auto& session : array<SessionDiagnosticsDataType>(client, sessions_array)) {
        CHECK(session.read_count.total_count <= 2);
        CHECK(session.write_count.total_count == 0);
        CHECK_FALSE(session.session_id.is_null());
    }
    // Set again while it is set it changes nothing.
    CHECK(enable(client, true) == status::Good);
    CHECK(array<SessionDiagnosticsDataType>(client, sessions_array).size() == 2);
}

TEST_CASE_METHOD(DiagnosticsFixture, "a session that is silent since then counts anew as well")
{
    TestClient silent = log_in();
    TestClient client = log_in_admin();
    for (int i = 0; i < 5; ++i) {
        CHECK(number(silent, current_sessions) == 2);
    }
    CHECK(enable(client, false) == status::Good);
    CHECK(enable(client, true) == status::Good);
    for (const auto& session : array<SessionDiagnosticsDataType>(client, sessions_array)) {
        CHECK(session.read_count.total_count <= 1);
    }
}

} // namespace diagnostics_test

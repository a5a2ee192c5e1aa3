#include <busbar/administration/audit_log.hpp>

#include <catch2/catch.hpp>

#include <optional>

#include <busbar/server/running_server.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/subscription.hpp>

#include "support/server_fixture.hpp"

namespace audit_log_test {

using namespace busbar;
using namespace busbar::test;
using administration::AuditLog;
using namespace std::chrono_literals;

namespace {

struct NoWaker final : server::Waker {
    void wake() override {}
};

/// A server whose audit events its clients get.
struct Fixture {
    Fixture() { audit.attach(server.event_queue(), "urn:busbar:test:server"); }

    static server::ServerConfig config()
    {
        server::ServerConfig config = ServerFixture::insecure_config();
        config.is_auditing = true;
        return config;
    }
    [[nodiscard]] TestClient connect(MessageSecurityMode mode)
    {
        return {server.connect("192.0.2.1", now).value(), setting("Basic256Sha256", mode),
                channel::ChannelEnvironment{.random = &random,
                                            .wall_clock = &wall_clock,
                                            .log = &lines,
                                            .validator = &validator,
                                            .identity = &client_identity()},
                now};
    }
    [[nodiscard]] TestClient log_in(const char* name,
                                    MessageSecurityMode mode = MessageSecurityMode::SignAndEncrypt)
    {
        TestClient client = connect(mode);
        REQUIRE(client.create_session());
        REQUIRE(client.activate(client.user(name, std::string{name} + "-secret")) == status::Good);
        return client;
    }
    /// From now on the client gets all events: EventType, ClientUserId, Status, StatusCodeId.
    static void subscribe(TestClient& client)
    {
        CreateSubscriptionRequest subscription;
        subscription.requested_publishing_interval = 100;
        subscription.requested_lifetime_count = 10'000;
        subscription.requested_max_keep_alive_count = 100;
        subscription.publishing_enabled = true;
        const auto made = client.call<CreateSubscriptionResponse>(subscription);
        REQUIRE(made);
        EventFilter filter;
        for (const char* name : {"EventType", "ClientUserId", "Status", "StatusCodeId",
                                 "SourceName", "ActionTimeStamp", "UserIdentityToken"}) {
            SimpleAttributeOperand operand;
            operand.type_definition_id = NodeId{0, id::BaseEventType};
            operand.browse_path = {QualifiedName{0, name}};
            operand.attribute_id = 13;
            filter.select_clauses.push_back(std::move(operand));
        }
        CreateMonitoredItemsRequest items;
        items.subscription_id = made->subscription_id;
        items.items_to_create.resize(1);
        items.items_to_create[0].item_to_monitor.node_id = NodeId{0, id::Server};
        items.items_to_create[0].item_to_monitor.attribute_id = 12; // EventNotifier
        items.items_to_create[0].monitoring_mode = MonitoringMode::Reporting;
        items.items_to_create[0].requested_parameters.queue_size = 100;
        items.items_to_create[0].requested_parameters.filter = ExtensionObject::from(filter);
        const auto created = client.call<CreateMonitoredItemsResponse>(items);
        REQUIRE(created);
        REQUIRE(created->results[0].status_code == status::Good);
    }
    /// "2071 pat true Good" for each event since the last call.
    std::vector<std::string> events(TestClient& client)
    {
        server.handle_completions(now);
        client.send(PublishRequest{});
        now += 100ms;
        wall_clock.time.ticks += 1'000'000;
        server.handle_deadline(now);
        client.run();
        std::vector<std::string> found;
        sources.clear();
        action_times.clear();
        tokens.clear();
        while (!client.messages.empty()) { // also answers to earlier requests
            const auto response = client.take<PublishResponse>(client.messages.front().request_id);
            if (!response || response->notification_message.notification_data.empty()) {
                continue;
            }
            const auto* const list =
                response->notification_message.notification_data[0].get_if<EventNotificationList>();
            REQUIRE(list != nullptr);
            for (const EventFieldList& event : list->events) {
                note(event.event_fields, found);
            }
        }
        return found;
    }
    void note(const Array<Variant>& fields, std::vector<std::string>& found)
    {
        found.push_back(to_string(fields[0].value_or<NodeId>({})) + " " +
                        fields[1].value_or<String>({}).str() + " " +
                        (fields[2].value_or<bool>(false) ? "true " : "false ") +
                        std::string{name(fields[3].value_or<StatusCode>({}))});
        sources.push_back(fields[4].value_or<String>({}).str());
        action_times.push_back(fields[5].value_or<DateTime>({}));
        tokens.push_back(fields[6].value_or<ExtensionObject>({}));
    }

    SeededRandom random;
    FixedWallClock wall_clock;
    LogBook lines;
    AuditLog audit{lines};
    crypto::InsecureAcceptAnyCertificate validator;
    PlainUsers users;
    NoWaker waker;
    TimePoint now{};
    /// SourceNames of the events that events() found last.
    std::vector<std::string> sources;
    std::vector<DateTime> action_times;
    std::vector<ExtensionObject> tokens;
    server::Server server{server::Server::create(config(), {.random = &random,
                                                            .wall_clock = &wall_clock,
                                                            .log = &audit,
                                                            .validator = &validator,
                                                            .users = &users,
                                                            .waker = &waker})
                              .value()};
};

using Lines = std::vector<std::string>;

} // namespace

TEST_CASE_METHOD(Fixture, "audit: SecurityAdmin sees channels and sessions come and go",
                 "[unit:Auditing Base][unit:Auditing Services][unit:Auditing Connections]"
                 "[unit:Auditing Secure Communication]")
{
    auto admin = log_in("admin");
    subscribe(admin);
    static_cast<void>(events(admin));
    auto pat = connect(MessageSecurityMode::Sign);
    CHECK(events(admin) == Lines{"i=2060 System/OpenSecureChannel true Good"});
    REQUIRE(pat.create_session());
    CHECK(events(admin) == Lines{"i=2071 System/CreateSession true Good"});
    const auto refused = pat.send_activate(pat.user("pat", "wrong"));
    CHECK(events(admin) == Lines{"i=2075 pat false Bad_UserAccessDenied"});
    now += 10s;
    pat.connection.handle_deadline(now);
    pat.run();
    CHECK(pat.take_activate(refused) == status::Bad_UserAccessDenied);
    REQUIRE(pat.activate(pat.user("pat", "pat-secret")) == status::Good);
    CHECK(events(admin) == Lines{"i=2075 pat true Good"});
    CHECK(pat.status_of<CancelResponse>(CancelRequest{}) == status::Good);
    CHECK(events(admin) == Lines{"i=2078 pat true Good"});
    CHECK(pat.close_session() == status::Good);
    CHECK(events(admin) == Lines{"i=2069 pat true Bad_SessionClosed"});
    ReadRequest request;
    request.nodes_to_read.resize(1);
    request.nodes_to_read[0].node_id = NodeId{0, id::Server_Auditing};
    request.nodes_to_read[0].attribute_id = 13;
    CHECK(admin.call<ReadResponse>(request)->results[0].value == Variant{true});
    CHECK(lines.text.find("\"test\" created from 192.0.2.1") != std::string::npos);
}

TEST_CASE_METHOD(Fixture, "audit: when users acted (Part 5, 6.4.3)", "[unit:Auditing Services]")
{
    const DateTime acted = DateTime::from_unix_seconds(1'700'000'000);
    auto admin = log_in("admin");
    subscribe(admin);
    static_cast<void>(events(admin));
    auto pat = connect(MessageSecurityMode::SignAndEncrypt);
    static_cast<void>(events(admin));
    pat.timestamp = acted;
    const std::vector<DateTime> once{acted};
    const auto is_told = [&] { return events(admin).size() == 1 && action_times == once; };

    REQUIRE(pat.create_session());
    CHECK(is_told());
    REQUIRE(pat.activate(pat.user("pat", "pat-secret")) == status::Good);
    CHECK(is_told());
    WriteRequest write;
    write.nodes_to_write.resize(1);
    write.nodes_to_write[0].attribute_id = 13;
    static_cast<void>(pat.call<WriteResponse>(write));
    CHECK(is_told());
    CallRequest call;
    call.methods_to_call.resize(1);
    static_cast<void>(pat.call<CallResponse>(call));
    CHECK(is_told());
    static_cast<void>(pat.call<CancelResponse>(CancelRequest{}));
    CHECK(is_told());
    CHECK(pat.close_session() == status::Good);
    CHECK(is_told());
}

TEST_CASE_METHOD(Fixture, "audit: tokens are told without their secrets (Part 5, 6.4.10)",
                 "[unit:Auditing Connections]")
{
    auto admin = log_in("admin");
    subscribe(admin);
    auto pat = connect(MessageSecurityMode::SignAndEncrypt);
    REQUIRE(pat.create_session());
    static_cast<void>(events(admin));
    const auto told = [&](const ExtensionObject& token) {
        const auto sent = pat.send_activate(token);
        static_cast<void>(pat.take_activate(sent));
        REQUIRE(events(admin).size() == 1);
        return tokens[0];
    };
    for (const char* password : {"pat-secret", "wrong"}) {
        CAPTURE(password);
        const ExtensionObject token = told(pat.user("pat", password));
        const auto* const user = token.get_if<UserNameIdentityToken>();
        REQUIRE(user != nullptr);
        CHECK(user->user_name.view() == "pat");
        CHECK_FALSE(user->policy_id.view().empty());
        CHECK(user->password.empty());
    }
    IssuedIdentityToken issued;
    issued.policy_id = "issued";
    issued.token_data = ByteString{std::as_bytes(std::span{"secret", 6})};
    const ExtensionObject token = told(ExtensionObject::from(issued));
    REQUIRE(token.get_if<IssuedIdentityToken>() != nullptr);
    CHECK(token.get_if<IssuedIdentityToken>()->token_data.empty());
}

TEST_CASE_METHOD(Fixture, "audit: how sessions and channels end (Part 4, 6.5.5 and 6.5.6)",
                 "[unit:Auditing Connections][unit:Auditing Secure Communication]")
{
    auto admin = log_in("admin");
    subscribe(admin);
    static_cast<void>(events(admin));
    auto pat = log_in("pat");
    static_cast<void>(events(admin));
    CHECK(pat.close_session() == status::Good);
    static_cast<void>(events(admin));
    CHECK(sources == Lines{"Session/CloseSession"});
    CHECK(audit.wants(RecordKind::ChannelOpened));
    CHECK_FALSE(audit.wants(RecordKind::ChannelRenewed)); // one that works
    pat.channel.close();
    pat.run();
    CHECK(events(admin) == Lines{"i=2059 System/CloseSecureChannel true Good"});
    CHECK(sources == Lines{"SecureChannel/CloseSecureChannel"});

    auto late = log_in("pat");
    static_cast<void>(events(admin));
    for (int i = 0; i < 13; ++i) { // more than a minute, with the administrator there
        now += 5s;
        server.handle_deadline(now);
        static_cast<void>(admin.status_of<ReadResponse>(ReadRequest{}));
    }
    Lines found = events(admin);
    CHECK(found == Lines{"i=2069 pat true Bad_SessionClosed"});
    CHECK(sources == Lines{"Session/Timeout"});

    auto ended = log_in("pat");
    static_cast<void>(events(admin));
    server::RunningServer{server}.end_sessions(
        [](const server::UserIdentity& user) { return user.name == "pat"; });
    found = events(admin);
    REQUIRE(found.size() == 1);
    CHECK(found[0].starts_with("i=2069 pat true "));
    CHECK(sources == Lines{"Session/Terminated"});
}

TEST_CASE_METHOD(Fixture, "audit: transferred Subscriptions are told", "[unit:Auditing Services]")
{
    auto admin = log_in("admin");
    subscribe(admin);
    auto pat = log_in("pat");
    static_cast<void>(events(admin));
    TransferSubscriptionsRequest request;
    request.subscription_ids = {7U};
    CHECK(pat.call<TransferSubscriptionsResponse>(request)->results[0].status_code ==
          status::Bad_SubscriptionIdInvalid);
    CHECK(events(admin) == Lines{"i=2069 pat false Bad_SubscriptionIdInvalid"});
    CHECK(sources == Lines{"Session/TransferSubscriptions"});
}

TEST_CASE_METHOD(Fixture, "audit: nobody else sees that, nor over a channel without encryption",
                 "[unit:Auditing Base]")
{
    auto pat = log_in("pat");
    auto weak = log_in("admin", MessageSecurityMode::Sign);
    auto admin = log_in("admin");
    subscribe(pat);
    subscribe(weak);
    subscribe(admin);
    static_cast<void>(events(admin));
    server.raise_event({});
    auto another = log_in("sam");
    server.handle_completions(now);
    CHECK(events(pat) == Lines{"i=2041  false Good"}); // what is no audit event
    CHECK(events(weak) == Lines{"i=2041  false Good"});
    CHECK(events(admin).size() == 4);
    another.close_session();
}

TEST_CASE_METHOD(Fixture, "audit: what waits is not for the session's next user", "[attack]")
{
    auto admin = log_in("admin");
    subscribe(admin);
    static_cast<void>(events(admin));
    auto sam = log_in("sam");
    server.handle_completions(now);
    server.handle_deadline(now);
    REQUIRE(admin.activate(admin.user("pat", "pat-secret")) == status::Good);
    sam.close_session();
    CHECK(events(admin) == Lines{"i=3035  false Good"}); // events were lost
    CHECK(events(admin) == Lines{});
    REQUIRE(admin.activate(admin.user("admin", "admin-secret")) == status::Good);
    static_cast<void>(events(admin));
    auto another = log_in("sam");
    CHECK(events(admin).size() == 3); // who has the right is told again
}

TEST_CASE_METHOD(Fixture, "audit: Writes and Calls, without secrets",
                 "[unit:Auditing Write][unit:Auditing Method][unit:Auditing NodeManagement]")
{
    auto admin = log_in("admin");
    subscribe(admin);
    static_cast<void>(events(admin));
    WriteRequest write;
    write.nodes_to_write.resize(1);
    write.nodes_to_write[0].node_id = NodeId{0, id::Server_ServiceLevel};
    write.nodes_to_write[0].attribute_id = 13;
    static_cast<void>(admin.call<WriteResponse>(write));
    CHECK(events(admin) == Lines{"i=2100 admin false Bad_NotWritable"});
    CallRequest call;
    call.methods_to_call.resize(1);
    call.methods_to_call[0].object_id = NodeId{0, id::Server};
    call.methods_to_call[0].method_id = NodeId{0, id::Server_ResendData};
    call.methods_to_call[0].input_arguments = {Variant{std::uint32_t{0}}};
    static_cast<void>(admin.call<CallResponse>(call));
    CHECK(events(admin) == Lines{"i=2127 admin false Bad_SubscriptionIdInvalid"});

    lines.keeps_records = true;
    call.methods_to_call[0].object_id = NodeId{0, id::UserManagementType};
    call.methods_to_call[0].method_id = NodeId{0, id::UserManagementType_AddUser};
    call.methods_to_call[0].input_arguments = {Variant{String{"pat"}}, Variant{String{"secret"}}};
    static_cast<void>(admin.call<CallResponse>(call));
    REQUIRE(lines.records.size() == 1);
    CHECK(lines.records[0].find("MethodCalled") == 0);
    CHECK(lines.records[0].find("InputArguments") == std::string::npos);
}

TEST_CASE("audit: each kind of record is an event of its type, or none")
{
    LogBook lines;
    AuditLog log{lines};
    CHECK_FALSE(log.wants(RecordKind::SessionCreated));
    FixedWallClock clock;
    auto queue = std::make_shared<server::EventQueue>(clock, nullptr, 4);
    log.attach(queue, "urn:server");
    CHECK(log.wants(RecordKind::SessionCreated));
    CHECK_FALSE(log.wants(RecordKind::CertificateExpiring));
    const NodeId node{2, "Speed"};
    const RecordField fields[] = {{"NodeId", Variant{node}},
                                  {"AttributeId", Variant{std::uint32_t{13}}}};
    Record record{RecordKind::AttributeWritten};
    record.fields = fields;
    const server::Event event = administration::audit_event(record, "urn:server");
    CHECK(event.source_node == node);
    CHECK(event.source_name == "Attribute/Write");
    for (const auto& [status, type] :
         {std::pair{status::Bad_CertificateUntrusted, id::AuditCertificateUntrustedEventType},
          std::pair{status::Bad_CertificateTimeInvalid, id::AuditCertificateExpiredEventType},
          std::pair{status::Bad_CertificateRevoked, id::AuditCertificateRevokedEventType},
          std::pair{status::Bad_CertificateUseNotAllowed, id::AuditCertificateMismatchEventType},
          std::pair{status::Bad_CertificateUriInvalid, id::AuditCertificateDataMismatchEventType},
          std::pair{status::Bad_CertificateInvalid, id::AuditCertificateInvalidEventType}}) {
        Record refused{RecordKind::CertificateRefused};
        refused.status = status;
        CHECK(administration::audit_event(refused, "").event_type == NodeId{0, type});
    }
    // A flood finds its end, and is counted.
    for (int i = 0; i < 10; ++i) {
        log.record(record);
    }
    CHECK(queue->dropped() == 6);
}

} // namespace audit_log_test

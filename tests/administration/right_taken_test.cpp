#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <busbar/server/running_server.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>

#include "trust_list_fixture.hpp"

namespace right_taken_test {

// A right counts when something is done, and not when it was begun: it is taken away in between.

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr const char* patience = "patience is all";

struct Taken : ManagedFixture {
    explicit Taken(server::Worker* w = nullptr) : ManagedFixture{w}
    {
        REQUIRE(user_list.add({"pat", {}, 0, {}, {}}, patience, random));
        // Or the last rule of SecurityAdmin would stay.
        configured.replace({{.name = "chief", .roles = {"SecurityAdmin"}}});
        REQUIRE(file_storage.make_folder("", FileAccess::Owner));
        REQUIRE(file_storage.replace("a", std::as_bytes(std::span{"first", 5}), FileAccess::Owner));
        administration->refresh_files();
        complete();
    }
    static IdentityMappingRuleType rule() { return {IdentityCriteriaType::UserName, "pat"}; }
    TestClient log_in_with(const char* role)
    {
        REQUIRE(roles.add_identity(role, rule()));
        return log_in("pat", patience);
    }
    void take(const char* role)
    {
        REQUIRE(roles.remove_identity(role, rule()));
        server::RunningServer{server}.roles_changed();
    }
};

/// What is opened, written and ended by Methods, the last of which has the effect.
struct Writing {
    const char* name;
    const char* role;
    /// Gives where to write, and the handle.
    std::function<std::pair<NodeId, Variant>(Taken&, TestClient&)> open;
    NodeId write;
    NodeId end;
    /// Null: the Object that is written.
    NodeId object_of_end;
    std::function<bool(Taken&)> is_unchanged;
};

std::pair<NodeId, Variant> opened(Taken& taken, TestClient& client, const NodeId& object,
                                  const NodeId& method)
{
    const auto result = taken.call(client, object, method, {Variant{writing}});
    REQUIRE(name(result.status_code) == "Good");
    return {object, result.output_arguments[0]};
}

std::vector<Writing> writings()
{
    const NodeId transfer{1, "Transfers/backup"};
    return {
        {"a file",
         "Engineer",
         [](Taken& taken, TestClient& client) {
             return opened(taken, client, NodeId{1, "Files/recipes/a"},
                           NodeId{1, "FileTypes/recipes//Open"});
         },
         NodeId{1, "FileTypes/recipes//Write"},
         NodeId{1, "FileTypes/recipes//Close"},
         {},
         [](Taken& taken) {
             const auto bytes = read_file(taken.file_storage, "a", 100);
             return bytes && bytes->size() == 5;
         }},
        {"a trust list",
         "SecurityAdmin",
         [](Taken& taken, TestClient& client) {
             return opened(taken, client, NodeId{0, trust_list}, NodeId{0, open_method});
         },
         NodeId{0, write_method},
         NodeId{0, close_and_update},
         {},
         [](Taken& taken) { return taken.count(taken.applications, StoreList::Trusted) == 1; }},
        {"a transfer",
         "Engineer",
         [transfer](Taken& taken, TestClient& client) {
             const auto result =
                 taken.call(client, transfer, NodeId{1, "Transfers/backup//GenerateFileForWrite"},
                            {Variant{}});
             REQUIRE(name(result.status_code) == "Good");
             return std::pair{*result.output_arguments[0].get_if<NodeId>(),
                              result.output_arguments[1]};
         },
         {},
         NodeId{1, "Transfers/backup//CloseAndCommit"},
         transfer,
         [](Taken& taken) { return taken.transfers.taken.empty(); }},
    };
}

/// An AddUser or AddIdentity, and more of them in one Call.
CallMethodRequest add_user(const char* name)
{
    CallMethodRequest call;
    call.object_id = NodeId{0, id::UserManagement};
    call.method_id = NodeId{0, id::UserManagement_AddUser};
    call.input_arguments = {Variant{String{name}}, Variant{String{patience}},
                            Variant{std::uint32_t{0}}, Variant{String{}}};
    return call;
}

CallMethodRequest add_observer(const char* name)
{
    constexpr std::uint32_t add_identity = 15672; // of Observer
    CallMethodRequest call;
    call.object_id = NodeId{0, id::WellKnownRole_Observer};
    call.method_id = NodeId{0, add_identity};
    call.input_arguments = {Variant{ExtensionObject::from(
        IdentityMappingRuleType{IdentityCriteriaType::UserName, String{name}})}};
    return call;
}

} // namespace

TEST_CASE("right taken: between Open and Write, and between Write and the end", "[attack]")
{
    for (const Writing& each : writings()) {
        for (const bool has_written : {false, true}) {
            INFO(each.name << (has_written ? ", after the Write" : ", before the Write"));
            Taken taken;
            auto pat = taken.log_in_with(each.role);
            const auto opened = each.open(taken, pat);
            const NodeId& object = opened.first;
            const Variant& handle = opened.second;
            const NodeId write = each.write.is_null()
                                     ? NodeId{1, String{object.string().str() + "//Write"}}
                                     : each.write;
            const auto write_it = [&] {
                return taken
                    .call(pat, object, write,
                          {handle, Variant{ByteString{std::as_bytes(std::span{"half", 4})}}})
                    .status_code;
            };
            if (has_written) {
                CHECK(name(write_it()) == "Good");
            }
            taken.take(each.role);
            CHECK(write_it().is_bad());
            CHECK(taken
                      .call(pat, each.object_of_end.is_null() ? object : each.object_of_end,
                            each.end, {handle})
                      .status_code.is_bad());
            CHECK(each.is_unchanged(taken));
            CHECK(pat.close_session() == status::Good);
            taken.complete();
            CHECK(each.is_unchanged(taken));
        }
    }
}

TEST_CASE_METHOD(Taken, "right taken: between two Methods of one Call", "[attack]")
{
    auto pat = log_in_with("SecurityAdmin");
    CallRequest request;
    request.methods_to_call = {add_observer("ann"), add_observer("bob"), add_observer("cat")};
    const auto sent = pat.send(request); // the first is done at once
    take("SecurityAdmin");
    complete();
    const auto response = pat.take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(name(response->results[0].status_code) == "Good");
    CHECK(response->results[1].status_code.is_bad());
    CHECK(response->results[2].status_code.is_bad());
    CHECK(roles.find("Observer")->identities.size() == 1);
}

TEST_CASE("right taken: while a Call waits for the worker", "[attack]")
{
    ManualWorker worker;
    Taken taken{&worker};
    auto pat = taken.log_in_with("SecurityAdmin");
    CallRequest request;
    request.methods_to_call = {add_user("ann")};
    const auto begun = pat.send(request);
    request.methods_to_call = {add_user("bob")};
    const auto waits = pat.send(request);
    REQUIRE(worker.jobs.size() == 1);
    taken.take("SecurityAdmin");
    worker.work();
    taken.complete();
    worker.work();
    taken.complete();
    const auto first = pat.take<CallResponse>(begun);
    const auto second = pat.take<CallResponse>(waits);
    REQUIRE((first && second));
    CHECK(first->results[0].status_code.is_bad());
    CHECK(second->results[0].status_code.is_bad());
    CHECK_FALSE(taken.user_list.find("ann"));
    CHECK_FALSE(taken.user_list.find("bob"));
}

TEST_CASE("right taken: a guess at a password counts that its session does not outlive", "[attack]")
{
    ManualWorker worker;
    Taken taken{&worker};
    const auto change = [](const char* from) {
        CallMethodRequest call;
        call.object_id = NodeId{0, id::UserManagement};
        call.method_id = NodeId{0, id::UserManagement_ChangePassword};
        call.input_arguments = {Variant{String{from}}, Variant{String{"my own choice"}}};
        return call;
    };
    const std::size_t most = taken.server.config().limits.max_login_failures;
    std::vector<TestClient> sessions;
    for (std::size_t i = 0; i <= most; ++i) {
        sessions.push_back(taken.log_in("pat", patience));
    }
    for (std::size_t i = 0; i < most; ++i) {
        CallRequest request;
        request.methods_to_call = {change("a guess that is wrong")};
        static_cast<void>(sessions[i].send(request));
        worker.work();
        CHECK(sessions[i].close_session() == status::Good);
        taken.complete();
    }
    const CallMethodRequest right = change(patience);
    CHECK(name(taken
                   .call(sessions.back(), right.object_id, right.method_id,
                         {right.input_arguments.begin(), right.input_arguments.end()})
                   .status_code) == "Bad_UserAccessDenied");
    CHECK(worker.jobs.empty());
}

TEST_CASE("right taken: while a file that is sent is looked at by the worker", "[attack]")
{
    ManualWorker worker;
    Taken taken{&worker};
    taken.transfers.is_slow = true;
    auto pat = taken.log_in_with("Engineer");
    const NodeId transfer{1, "Transfers/backup"};
    const auto file =
        taken.call(pat, transfer, NodeId{1, "Transfers/backup//GenerateFileForWrite"}, {Variant{}});
    REQUIRE(name(file.status_code) == "Good");
    CallMethodRequest commit;
    commit.object_id = transfer;
    commit.method_id = NodeId{1, "Transfers/backup//CloseAndCommit"};
    commit.input_arguments = {file.output_arguments[1]};
    CallRequest request;
    request.methods_to_call = {commit};
    const auto sent = pat.send(request);
    REQUIRE(worker.jobs.size() == 1);
    SECTION("the right is gone")
    {
        taken.take("Engineer");
        worker.work();
        taken.complete();
        const auto response = pat.take<CallResponse>(sent);
        REQUIRE(response);
        CHECK(response->results[0].status_code.is_bad());
    }
    SECTION("the session is gone")
    {
        CHECK(pat.close_session() == status::Good);
        worker.work();
        taken.complete();
    }
    CHECK(taken.transfers.prepared.size() == 1);
    CHECK(taken.transfers.taken.empty());
}

namespace {

struct Subscribed : Taken {
    /// With an item for each; they report each time the server samples.
    void subscribe(TestClient& client, const std::vector<NodeId>& variables)
    {
        CreateSubscriptionRequest subscription;
        subscription.requested_publishing_interval = 100;
        subscription.requested_lifetime_count = 300;
        subscription.requested_max_keep_alive_count = 10;
        subscription.publishing_enabled = true;
        const auto made = client.call<CreateSubscriptionResponse>(subscription);
        REQUIRE(made);
        CreateMonitoredItemsRequest request;
        request.subscription_id = made->subscription_id;
        for (const NodeId& variable : variables) {
            MonitoredItemCreateRequest& item = request.items_to_create.emplace_back();
            item.item_to_monitor.node_id = variable;
            item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
            item.monitoring_mode = MonitoringMode::Reporting;
            item.requested_parameters.sampling_interval = 100;
            item.requested_parameters.queue_size = 10;
        }
        const auto items = client.call<CreateMonitoredItemsResponse>(request);
        REQUIRE(items);
        for (const auto& each : items->results) {
            REQUIRE(name(each.status_code) == "Good");
        }
    }
    /// With an item for the events of the server.
    static void subscribe_to_events(TestClient& client)
    {
        CreateSubscriptionRequest subscription;
        subscription.requested_publishing_interval = 100;
        subscription.requested_lifetime_count = 300;
        subscription.requested_max_keep_alive_count = 10;
        subscription.publishing_enabled = true;
        const auto made = client.call<CreateSubscriptionResponse>(subscription);
        REQUIRE(made);
        EventFilter filter;
        SimpleAttributeOperand& type = filter.select_clauses.emplace_back();
        type.type_definition_id = NodeId{0, id::BaseEventType};
        type.browse_path = {QualifiedName{0, "EventType"}};
        type.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        CreateMonitoredItemsRequest request;
        request.subscription_id = made->subscription_id;
        MonitoredItemCreateRequest& item = request.items_to_create.emplace_back();
        item.item_to_monitor.node_id = NodeId{0, id::Server};
        item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::EventNotifier);
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.queue_size = 10;
        item.requested_parameters.filter = ExtensionObject::from(filter);
        const auto items = client.call<CreateMonitoredItemsResponse>(request);
        REQUIRE(items);
        REQUIRE(name(items->results[0].status_code) == "Good");
    }
    /// The number of audit events that come.
    std::size_t events(TestClient& client)
    {
        using namespace std::chrono_literals;
        client.send(PublishRequest{});
        for (int i = 0; i < 20; ++i) {
            complete();
            advance(100ms);
            client.run();
        }
        std::size_t count = 0;
        while (!client.messages.empty()) { // also answers to earlier requests
            const auto response = client.take<PublishResponse>(client.messages.front().request_id);
            REQUIRE(response);
            for (const auto& data : response->notification_message.notification_data) {
                const auto* const list = data.get_if<EventNotificationList>();
                REQUIRE(list != nullptr);
                count += static_cast<std::size_t>(std::count_if(
                    list->events.begin(), list->events.end(), [](const EventFieldList& event) {
                        return event.event_fields[0] == Variant{NodeId{0, id::AuditEventType}};
                    }));
            }
        }
        return count;
    }
    /// The values that the next notifications bring.
    std::vector<DataValue> publish(TestClient& client)
    {
        using namespace std::chrono_literals;
        std::vector<DataValue> values;
        const auto sent = client.send(PublishRequest{});
        for (int i = 0; i < 20; ++i) {
            advance(100ms);
            complete();
            client.run();
        }
        const auto response = client.take<PublishResponse>(sent);
        REQUIRE(response);
        for (const auto& data : response->notification_message.notification_data) {
            if (const auto* const changes = data.get_if<DataChangeNotification>()) {
                for (const auto& each : changes->monitored_items) {
                    values.push_back(each.value);
                }
            }
        }
        return values;
    }
};

} // namespace

TEST_CASE_METHOD(Subscribed, "right taken: between the creation of an item and what it reports",
                 "[attack]")
{
    constexpr std::uint32_t identities = 16214; // of Observer
    auto pat = log_in_with("SecurityAdmin");
    subscribe(pat, {NodeId{0, id::UserManagement_Users}, NodeId{0, identities},
                    NodeId{1, "Settings.limits.sessions"}, NodeId{1, "Settings.users.anonymous"}});
    const auto before = publish(pat);
    REQUIRE(before.size() == 4);
    for (const DataValue& each : before) {
        CHECK(each.status.is_good());
    }
    take("SecurityAdmin");
    REQUIRE(user_list.add({"ann", {}, 0, {}, {}}, patience, random));
    REQUIRE(roles.add_identity("Observer", {IdentityCriteriaType::UserName, "ann"}));
    owner.applied["limits.sessions"] = Variant{std::int64_t{12}};
    owner.applied["users.anonymous"] = Variant{"write"};
    for (int i = 0; i < 2; ++i) {
        for (const DataValue& each : publish(pat)) {
            CHECK(each.status.is_bad());
            CHECK(each.value.is_null());
        }
    }
}

TEST_CASE_METHOD(Subscribed, "right taken: between the creation of an item and an audit event",
                 "[attack]")
{
    auto pat = log_in_with("SecurityAdmin");
    subscribe_to_events(pat);
    const auto raise = [&] {
        server::Event event;
        event.event_type = NodeId{0, id::AuditEventType};
        server.raise_event(std::move(event));
    };
    raise();
    CHECK(events(pat) == 1);
    raise();
    complete(); // it waits for its publication
    take("SecurityAdmin");
    CHECK(events(pat) == 0);
    raise();
    CHECK(events(pat) == 0);
    CHECK(events(pat) == 0);
    REQUIRE(roles.add_identity("SecurityAdmin", rule()));
    server::RunningServer{server}.roles_changed();
    CHECK(events(pat) == 0);
    raise();
    CHECK(events(pat) + events(pat) == 1);
}

} // namespace right_taken_test

#include <catch2/catch.hpp>

#include <busbar/server/method_table.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/view.hpp>

#include "item_fixture.hpp"

namespace server_state_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// Does nothing, and is there whatever the server's state is.
struct OwnSource final : server::DataSource {
    [[nodiscard]] server::DataSourceOptions options() const override
    {
        server::DataSourceOptions options;
        options.is_always_in_service = true;
        return options;
    }
    void read(server::ReadBatch batch) override
    {
        batch.results()[0].status = status::Good;
        batch.results()[0].value = Variant{5};
        batch.complete();
    }
};

struct Sources {
    server::MethodTable methods;
    OwnSource own_source;
};

/// `level` of a source, `kept` of the address space, `own` of the server's, and a Method "Go".
struct StateFixture : Sources, ItemFixture {
    StateFixture()
    {
        model::NewMethod method;
        method.source = server.add_source(methods);
        method.handle = methods.add([](server::MethodCall call) { call.succeed({}); });
        model::NewNode node;
        node.id = NodeId{1, "Go"};
        node.browse_name = QualifiedName{1, "Go"};
        node.parent = server.address_space().find(id::ObjectsFolder);
        REQUIRE(server.address_space().add_method(node, method));
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Int32};
        variable.value = 3;
        kept = add_variable("kept", variable);
        variable.source = server.add_source(own_source);
        own = add_variable("own", variable);
        users.everybody.access_level_mask = 0xFF; // who may call Methods
        REQUIRE(client.activate(TestClient::anonymous()) == status::Good);
    }
    bool change(ServerState state, DateTime back = {})
    {
        return server::RunningServer{server}.change_state(state, "a visit of the inspector", back);
    }
    DataValue read(const NodeId& node)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = node;
        request.nodes_to_read[0].attribute_id = 13;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    DataValue read(std::uint32_t of_server) { return read(NodeId{0, of_server}); }
    StatusCode call()
    {
        CallRequest request;
        request.methods_to_call.resize(1);
        request.methods_to_call[0].object_id = NodeId{0, id::ObjectsFolder};
        request.methods_to_call[0].method_id = NodeId{1, "Go"};
        const auto response = client.call<CallResponse>(request);
        return response ? response->results[0].status_code : response.error();
    }
    StatusCode browse()
    {
        BrowseRequest request;
        request.nodes_to_browse.resize(1);
        request.nodes_to_browse[0].node_id = NodeId{0, id::ObjectsFolder};
        return client.status_of<BrowseResponse>(request);
    }

    NodeId kept, own;
};

} // namespace

TEST_CASE_METHOD(StateFixture, "a suspended server exchanges no data with its sources")
{
    const DateTime back{today.ticks + 3'600 * DateTime::ticks_per_second};
    CHECK(read(id::Server_ServiceLevel).value == Variant{std::uint8_t{255}});
    REQUIRE(change(ServerState::Suspended, back));
    CHECK(read(level).status == status::Bad_OutOfService);
    CHECK(call() == status::Bad_OutOfService);
    CHECK(read(kept).value == Variant{3});
    CHECK(read(own).value == Variant{5});
    CHECK(browse() == status::Good);
    CHECK(read(id::Server_ServerStatus_State).value == Variant{ServerState::Suspended});
    CHECK(read(id::Server_ServiceLevel).value == Variant{std::uint8_t{0}});
    CHECK(read(id::Server_EstimatedReturnTime).value == Variant{back});
    CHECK(read(id::Server_ServerStatus_ShutdownReason).value == Variant{LocalizedText{}});
    CHECK(log.text.find("suspended: a visit of the inspector") != std::string::npos);

    // One that comes meanwhile is no exception.
    server::MemorySource late{source_clock};
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.source = server.add_source(late);
    variable.handle = late.add(1);
    const NodeId of_late = add_variable("late", variable);
    CHECK(read(of_late).status == status::Bad_OutOfService);

    REQUIRE(change(ServerState::Running));
    CHECK(read(level).value == Variant{1});
    CHECK(read(of_late).value == Variant{1});
    CHECK(call() == status::Good);
    CHECK(read(id::Server_ServerStatus_State).value == Variant{ServerState::Running});
    CHECK(read(id::Server_ServiceLevel).value == Variant{std::uint8_t{255}});
    CHECK(read(id::Server_EstimatedReturnTime).value == Variant{DateTime{}}); // Part 5, 9.4
}

TEST_CASE_METHOD(StateFixture, "a server that has failed says so and does little else")
{
    REQUIRE(change(ServerState::Failed));
    CHECK(browse() == status::Bad_ServerHalted);
    CHECK(client.status_of<CreateSubscriptionResponse>(subscription_request()) ==
          status::Bad_ServerHalted);
    CHECK(read(level).status == status::Bad_ServerHalted);
    CHECK(call() == status::Bad_ServerHalted);
    CHECK(read(id::Server_ServerStatus_State).value == Variant{ServerState::Failed});
    CHECK(read(id::Server_ServiceLevel).value == Variant{std::uint8_t{1}});
    TestClient another = log_in(); // perhaps an administrator
    CHECK(another.close_session() == status::Good);
    REQUIRE(change(ServerState::Suspended));
    CHECK(browse() == status::Good);
    CHECK(read(level).status == status::Bad_OutOfService);
}

TEST_CASE_METHOD(StateFixture, "subscriptions outlive the time for which a server is suspended")
{
    monitor_level([](auto&) {});
    REQUIRE(change(ServerState::Suspended));
    set(0, 2);
    auto told = next_data(client, cycle);
    REQUIRE(told.size() == 1);
    CHECK(told[0].value.status == status::Bad_OutOfService);
    CHECK(next_data(client, cycle).empty());
    REQUIRE(change(ServerState::Running));
    told = next_data(client, cycle);
    REQUIRE(told.size() == 1);
    CHECK(told[0].value.value == Variant{2});
}

TEST_CASE_METHOD(StateFixture, "a server enters no state that is not its own to choose")
{
    CHECK_FALSE(change(ServerState::Test));
    CHECK_FALSE(change(ServerState::Shutdown));
    CHECK(change(ServerState::Running)); // it is, and nobody needs to be told
    CHECK(*read(id::Server_EstimatedReturnTime).value.get_if<DateTime>() == today);
    REQUIRE(change(ServerState::Suspended));
    server.begin_shutdown(now, "for good");
    CHECK_FALSE(change(ServerState::Running));
    CHECK(read(level).status == status::Bad_OutOfService);
    CHECK(read(id::Server_ServerStatus_State).value == Variant{ServerState::Shutdown});
}

TEST_CASE_METHOD(StateFixture, "a countdown serves the server's own Methods, and can be taken back")
{
    struct Heir final : server::CountdownHeir {
        ServerState countdown_ended() override
        {
            is_told = true;
            return ServerState::Shutdown;
        }
        bool is_told{false};
    } heir;
    const auto begin = [&] {
        return server::RunningServer{server}.begin_countdown("the line is moved", 60s, {}, heir);
    };
    REQUIRE(begin());
    CHECK(read(id::Server_ServerStatus_State).value == Variant{ServerState::Shutdown});
    CHECK(call() == status::Bad_Shutdown); // which is not the service's
    CHECK(browse() == status::Bad_Shutdown);
    CHECK_FALSE(server.connect("192.0.2.9", now));
    CHECK_FALSE(change(ServerState::Suspended));
    REQUIRE(change(ServerState::Running));
    CHECK(call() == status::Good);
    CHECK(browse() == status::Good);
    CHECK(read(id::Server_ServerStatus_SecondsTillShutdown).value == Variant{std::uint32_t{0}});
    now += 61s;
    server.handle_deadline(now);
    CHECK_FALSE(heir.is_told);
    // A shutdown of the program's takes its place, and is final.
    REQUIRE(begin());
    server.begin_shutdown(now, "a signal");
    CHECK_FALSE(begin());
    CHECK_FALSE(change(ServerState::Running));
    now += 61s;
    server.handle_deadline(now);
    CHECK_FALSE(heir.is_told);
    CHECK(client.is_closed());
}

TEST_CASE_METHOD(StateFixture, "a countdown may end in a server that is open to administrators")
{
    struct Heir final : server::CountdownHeir {
        ServerState countdown_ended() override { return ServerState::Failed; }
    } heir;
    REQUIRE(server::RunningServer{server}.begin_countdown("the line is moved", 60s, {}, heir));
    now += 61s;
    server.handle_deadline(now);
    CHECK(client.is_closed());
    CHECK_FALSE(server.is_stopped());
    CHECK(server::RunningServer{server}.state() == ServerState::Failed);
    CHECK(server.connect("192.0.2.9", now));
    now += 61s;
    server.handle_deadline(now);
    CHECK(server::RunningServer{server}.state() == ServerState::Failed);
    CHECK(change(ServerState::Running));
}

} // namespace server_state_test

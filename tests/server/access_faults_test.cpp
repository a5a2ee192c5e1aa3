#include <catch2/catch.hpp>

#include <busbar/types/node_management.hpp>
#include <busbar/types/view.hpp>

#include "method_fixture.hpp"
#include "subscription_fixture.hpp"
#include "thrown.hpp"

namespace access_faults_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

struct BrokenAccess final : server::AccessControl {
    [[nodiscard]] bool may_browse(const server::UserIdentity&, const NodeId& node) const override
    {
        throw_if(node == at);
        return true;
    }
    [[nodiscard]] std::uint8_t user_access_level(const server::UserIdentity&, const NodeId& node,
                                                 std::uint8_t level) const override
    {
        throw_if(node == at);
        return level;
    }
    [[nodiscard]] bool may_call(const server::UserIdentity&, const NodeId& node) const override
    {
        throw_if(node == callable);
        return true;
    }
    [[nodiscard]] bool may_add_node(const server::UserIdentity&,
                                    const NodeId& parent) const override
    {
        throw_if(parent == at);
        return true;
    }
    NodeId at;
    NodeId callable;
};

} // namespace

TEST_CASE("a request whose AccessControl throws answers Bad_InternalError")
{
    BrokenAccess access;
    MethodFixture fixture{ServerFixture::insecure_config(), &access};
    const NodeId sum = fixture.add_sum();
    TestClient client = fixture.log_in();
    access.at = NodeId{0, id::Server_ServerStatus_State};
    CHECK(use(client) == status::Bad_InternalError);
    CHECK(fixture.log.text.find("AccessControl::may_browse threw: bus error") != std::string::npos);
    access.at = {};
    CHECK(use(client) == status::Good);
    access.callable = sum;
    CHECK(client.status_of<CallResponse>(MethodFixture::request(
              {MethodFixture::to_call(sum, {1, 2})})) == status::Bad_InternalError);
    CHECK(fixture.log.text.find("AccessControl::may_call threw") != std::string::npos);
    CHECK(use(client) == status::Good);
}

TEST_CASE("what a request made before its AccessControl threw is gone again")
{
    BrokenAccess access;
    MethodFixture fixture{ServerFixture::insecure_config(), &access};
    TestClient client = fixture.log_in();
    access.at = NodeId{0, id::Server_ServerStatus_State};
    CreateMonitoredItemsRequest create;
    create.subscription_id =
        client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request())
            .value()
            .subscription_id;
    const auto add_items = [&](std::uint32_t node, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            create.items_to_create.push_back(SubscriptionFixture::item_request(NodeId{0, node}));
        }
    };
    SECTION("at once")
    {
        add_items(id::Server_ServerStatus_CurrentTime, 2);
        add_items(id::Server_ServerStatus_State, 1);
    }
    SECTION("in a later turn")
    {
        add_items(id::Server_ServerStatus_CurrentTime, 200);
        add_items(id::Server_ServerStatus_State, 1);
        add_items(id::Server_ServerStatus_CurrentTime, 200);
    }
    const std::uint32_t request = client.send(create);
    while (client.connection.next_deadline() <= fixture.now) {
        client.connection.handle_deadline(fixture.now);
    }
    CHECK(client.take<CreateMonitoredItemsResponse>(request).error() == status::Bad_InternalError);
    CHECK(fixture.server.monitored_item_count() == 0);
    access.at = {};
    CHECK(client.status_of<CreateMonitoredItemsResponse>(create) != status::Bad_InternalError);
}

TEST_CASE("what throws in one turn of a request is its answer, though others follow")
{
    BrokenAccess access;
    MethodFixture fixture{ServerFixture::insecure_config(), &access};
    TestClient client = fixture.log_in();
    BrowseRequest browse;
    BrowseDescription one;
    one.node_id = NodeId{0, id::ObjectsFolder};
    one.include_subtypes = true;
    one.result_mask = 63;
    browse.nodes_to_browse.resize(1'000);
    std::fill(browse.nodes_to_browse.begin(), browse.nodes_to_browse.end(), one);
    browse.nodes_to_browse[500].node_id = access.at = NodeId{0, id::TypesFolder};
    const std::uint32_t request = client.send(browse);
    std::size_t turns = 1;
    for (; client.connection.next_deadline() <= fixture.now; ++turns) {
        client.connection.handle_deadline(fixture.now);
    }
    CHECK(turns > 2);
    CHECK(client.take<BrowseResponse>(request).error() == status::Bad_InternalError);
    CHECK(use(client) == status::Good);
}

TEST_CASE("what throws in a later turn of a Read is its answer")
{
    BrokenAccess access;
    MethodFixture fixture{ServerFixture::insecure_config(), &access};
    TestClient client = fixture.log_in();
    ReadRequest read;
    ReadValueId one;
    one.node_id = NodeId{0, id::Server_ServerStatus_CurrentTime};
    one.attribute_id = 13;
    read.nodes_to_read.resize(10'000);
    std::fill(read.nodes_to_read.begin(), read.nodes_to_read.end(), one);
    read.nodes_to_read[8'000].node_id = access.at = NodeId{0, id::Server_ServerStatus_State};
    const std::uint32_t request = client.send(read);
    std::size_t turns = 1;
    for (; client.connection.next_deadline() <= fixture.now; ++turns) {
        client.connection.handle_deadline(fixture.now);
    }
    CHECK(turns > 2);
    CHECK(client.take<ReadResponse>(request).error() == status::Bad_InternalError);
    access.at = {};
    CHECK(use(client) == status::Good);
}

TEST_CASE("nodes that a request added before its AccessControl threw are gone again")
{
    BrokenAccess access;
    server::ServerConfig config = ServerFixture::insecure_config();
    config.has_node_management = true;
    MethodFixture fixture{config, &access};
    TestClient client = fixture.log_in();
    AddNodesRequest request;
    for (const char* name : {"first", "second"}) {
        AddNodesItem& item = request.nodes_to_add.emplace_back();
        item.parent_node_id = NodeId{0, id::ObjectsFolder};
        item.reference_type_id = NodeId{0, id::Organizes};
        item.requested_new_node_id = NodeId{1, name};
        item.browse_name = {1, name};
        item.node_class = NodeClass::Object;
        item.type_definition = NodeId{0, id::FolderType};
    }
    const std::size_t before = fixture.server.address_space().node_count();
    request.nodes_to_add[1].parent_node_id = access.at = NodeId{0, id::TypesFolder};
    CHECK(client.status_of<AddNodesResponse>(request) == status::Bad_InternalError);
    CHECK(fixture.server.address_space().node_count() == before);
    access.at = {};
    const auto added = client.call<AddNodesResponse>(request).value();
    CHECK(added.results[0].status_code == status::Good);
    CHECK(fixture.server.address_space().node_count() == before + 2);
}

} // namespace access_faults_test

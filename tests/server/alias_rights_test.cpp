#include <catch2/catch.hpp>

#include "server/rights/registered_nodes.hpp"
#include "subscription_fixture.hpp"

namespace alias_rights_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using server::detail::RegisteredNodes;

// Who registers a node looks it up in advance (Part 4, 5.9.5), and gets no right by that which
// would last longer: each Read, Write and sample by alias is answered as by NodeId.

namespace {

/// Lets in whom a test wants.
class NextUser final : public server::UserStore {
public:
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view, std::string_view) override
    {
        return next;
    }
    [[nodiscard]] server::UserIdentity anonymous() const override
    {
        return server::anonymous_reader();
    }

    server::UserIdentity next{UserTokenType::UserName, "operator"};
};

/// Only one user may see, read and write anything of namespace 1.
class OneUser final : public server::AccessControl {
public:
    [[nodiscard]] bool may_browse(const server::UserIdentity& user,
                                  const NodeId& node) const override
    {
        return node.namespace_index() == 0 || user.name == seer;
    }
    [[nodiscard]] std::uint8_t user_access_level(const server::UserIdentity& user, const NodeId&,
                                                 std::uint8_t access_level) const override
    {
        return user.name == reader ? access_level : std::uint8_t{0};
    }

    std::string seer{"operator"};
    std::string reader{"operator"};
};

struct Rights {
    NextUser store;
    OneUser access;
};

struct AliasRights : Rights, SubscriptionParts, ServerFixture {
    AliasRights()
    {
        server = server::Server::create(insecure_config(), {.random = &random,
                                                            .wall_clock = &wall_clock,
                                                            .log = &log,
                                                            .validator = &validator,
                                                            .users = &store,
                                                            .access = &access})
                     .value();
        model::NewVariable variable;
        variable.source = server.add_source(memory);
        variable.handle = memory.add(Variant{std::int32_t{1}});
        variable.data_type = NodeId{0, id::Int32};
        variable.value_rank = -1;
        variable.access_level = model::Access::ReadWrite;
        model::NewNode node;
        node.id = level;
        node.browse_name = QualifiedName{1, "level"};
        node.parent = server.address_space().find(id::ObjectsFolder);
        REQUIRE(server.address_space().add_variable(node, variable));
        client.emplace(connect());
        REQUIRE(client->create_session());
        activate();
        RegisterNodesRequest request;
        request.nodes_to_register = {level};
        alias = client->call<RegisterNodesResponse>(request).value().registered_node_ids[0];
        REQUIRE(RegisteredNodes::is_alias(alias));
        REQUIRE(read(alias) == status::Good);
        REQUIRE(write(alias) == status::Good);
    }
    /// The session gets the user whom the store has next.
    void activate() { REQUIRE(client->activate(client->user("any", "secret")) == status::Good); }
    StatusCode read(const NodeId& node)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = node;
        request.nodes_to_read[0].attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        return client->call<ReadResponse>(request).value().results[0].status;
    }
    StatusCode write(const NodeId& node)
    {
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = node;
        request.nodes_to_write[0].attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        request.nodes_to_write[0].value.value = Variant{std::int32_t{2}};
        return client->call<WriteResponse>(request).value().results[0];
    }
    StatusCode monitor(const NodeId& node)
    {
        const auto made =
            client->call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request());
        return SubscriptionFixture::monitor(*client, made.value().subscription_id,
                                            SubscriptionFixture::item_request(node))
            .status_code;
    }
    StatusCode browse(const NodeId& node)
    {
        BrowseRequest request;
        request.nodes_to_browse.resize(1);
        request.nodes_to_browse[0].node_id = node;
        return client->call<BrowseResponse>(request).value().results[0].status_code;
    }
    void check_all(StatusCode read_status, StatusCode write_status, StatusCode browse_status)
    {
        for (const NodeId& node : {alias, level}) {
            CAPTURE(to_string(node));
            CHECK(read(node) == read_status);
            CHECK(write(node) == write_status);
            CHECK(browse(node) == browse_status);
        }
        CHECK(monitor(alias) == monitor(level));
    }

    NodeId level{1, "level"};
    NodeId alias;
    std::optional<TestClient> client;
};

} // namespace

TEST_CASE_METHOD(AliasRights, "an alias is not read nor written after the right has gone",
                 "[attack]")
{
    access.reader = "nobody";
    check_all(status::Bad_UserAccessDenied, status::Bad_UserAccessDenied, status::Good);
    access.reader = "operator";
    check_all(status::Good, status::Good, status::Good);
}

TEST_CASE_METHOD(AliasRights, "an alias of a node that is no longer shown is of no node",
                 "[attack]")
{
    access.seer = "nobody";
    check_all(status::Bad_NodeIdUnknown, status::Bad_NodeIdUnknown, status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(AliasRights, "an alias gives the session's next user no right", "[attack]")
{
    store.next.name = "guest";
    access.seer = "guest";
    activate();
    check_all(status::Bad_UserAccessDenied, status::Bad_UserAccessDenied, status::Good);
    access.seer = "operator";
    check_all(status::Bad_NodeIdUnknown, status::Bad_NodeIdUnknown, status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(AliasRights, "an alias follows the permissions of its node", "[attack]")
{
    model::AddressSpace& space = server.address_space();
    model::NodeAccess nobody;
    nobody.role_permissions = Array<RolePermissionType>{std::vector<RolePermissionType>{}};
    space.set_node_access(space.find(level), nobody);
    for (const NodeId& node : {alias, level}) {
        CHECK(read(node).is_bad());
        CHECK(write(node).is_bad());
        CHECK(monitor(node).is_bad());
    }
    CHECK(read(alias) == read(level));
    space.set_node_access(space.find(level), {});
    check_all(status::Good, status::Good, status::Good);
}

} // namespace alias_rights_test

#include <catch2/catch.hpp>

#include <set>

#include <busbar/types/attribute.hpp>
#include <busbar/types/node_management.hpp>
#include <busbar/types/view.hpp>

#include "server/rights/registered_nodes.hpp"
#include "subscription_fixture.hpp"
#include "view_fixture.hpp"

namespace registered_nodes_test {

using namespace busbar;
using namespace busbar::test;
using busbar::server::detail::HidesOne;
using busbar::server::detail::RegisteredNodes;
using busbar::server::detail::ViewFixture;

namespace {

/// So that the first identifier is at the end of its range, and the NamespaceIndex near it.
constexpr RegisteredNodes::Lot lot{std::byte{0xFE}, std::byte{0xFF}, std::byte{0xFF},
                                   std::byte{0xFF}, std::byte{0xFF}, std::byte{0xFF}};

struct Registered : model::ModelFixture {
    NodeId add(model::NodeIndex node)
    {
        registered.make_places(registered.missing(1));
        return registered.add(node);
    }
    model::NodeIndex a{add_int32("a", objects)};
    model::NodeIndex b{add_int32("b", objects)};
    RegisteredNodes registered{space, lot};
};

} // namespace

TEST_CASE_METHOD(Registered, "an alias is a place that has the node")
{
    registered.make_places(registered.missing(100));
    std::vector<NodeId> aliases;
    for (int i = 0; i < 100; ++i) {
        aliases.push_back(registered.add(i % 2 == 0 ? a : b));
    }
    CHECK(std::set<NodeId>(aliases.begin(), aliases.end()).size() == 100);
    CHECK(registered.missing(3) == 3);
    // Aliases, other NodeIds, and what is neither.
    aliases.insert(aliases.begin() + 50,
                   {space.node_id(b), NodeId{0, id::Server}, NodeId{ns, "none"},
                    NodeId{RegisteredNodes::first_namespace, 5}});
    std::vector<const NodeId*> ids;
    std::vector<model::NodeIndex> expected;
    for (const NodeId& each : aliases) {
        CHECK(RegisteredNodes::is_alias(each) == (each.namespace_index() >= 0x8000));
        ids.push_back(&each);
        const model::NodeIndex of_alias = registered.find(each);
        expected.push_back(of_alias != model::no_node ? of_alias : space.find(each));
    }
    CHECK(expected[0] == a);
    CHECK(expected[50] == b);
    CHECK(expected[53] == model::no_node);
    CHECK(expected.back() == b);
    std::vector<model::NodeIndex> found(ids.size());
    registered.find_nodes(ids, found);
    CHECK(found == expected);
    CHECK(registered.canonical(aliases[1]) == space.node_id(b));
    CHECK_FALSE(registered.canonical(space.node_id(b)));
}

TEST_CASE_METHOD(Registered, "an alias leads to no other node than its own")
{
    const NodeId alias = add(a);
    const NodeId kept = add(b);
    REQUIRE(space.remove(a));
    CHECK(registered.find(alias) == model::no_node);
    const model::NodeIndex another = add_int32("another", objects);
    CHECK(another == a); // its index is used again
    CHECK(registered.find(alias) == model::no_node);

    registered.remove(kept);
    CHECK(registered.find(kept) == model::no_node);
    registered.remove(kept);
    CHECK(registered.missing(2) == 1);
    const NodeId next = add(another);
    CHECK(registered.find(next) == another);
    CHECK(registered.find(kept) == model::no_node);

    // What another session calls so, or the same server after a restart.
    RegisteredNodes::Lot other = lot;
    other[5] = std::byte{0};
    RegisteredNodes elsewhere{space, other};
    elsewhere.make_places(2);
    static_cast<void>(elsewhere.add(b));
    CHECK(elsewhere.find(alias) == model::no_node);
    CHECK(elsewhere.find(next) == model::no_node);
}

TEST_CASE_METHOD(Registered, "a place is given up when it has had all of its NodeIds")
{
    std::set<NodeId> all;
    const unsigned most = 0x10000U - RegisteredNodes::first_namespace;
    for (unsigned i = 0; i < most; ++i) {
        const NodeId alias = add(a);
        REQUIRE(registered.find(alias) == a);
        all.insert(alias);
        registered.remove(alias);
    }
    CHECK(all.size() == most);
    CHECK(registered.missing(1) == 1);
    CHECK(all.insert(add(a)).second);
}

TEST_CASE_METHOD(ViewFixture, "RegisterNodes has aliases for Variables that the user may see",
                 "[unit:View RegisterNodes]")
{
    add_children(3);
    const HidesOne hides{node("v1")};
    control = &hides;
    server::detail::ViewContext view = context();
    RegisterNodesRequest request;
    request.nodes_to_register = {node("v0"),
                                 node("v1"),
                                 node("folder"),
                                 NodeId{ns, "nowhere"},
                                 NodeId{0, id::Server_ServerStatus_CurrentTime},
                                 node("v2")};
    RegisterNodesResponse response;
    const auto& ids = response.registered_node_ids;
    view.turn = server::detail::Turn{20}; // two nodes
    REQUIRE(register_nodes(view, request, response) == status::Good);
    REQUIRE(ids.size() == 6);
    for (std::size_t i = 1; i < 5; ++i) {
        CHECK(ids[i] == request.nodes_to_register[i]);
    }
    REQUIRE(session.registered != nullptr);
    CHECK(session.registered->find(ids[0]) == find("v0"));
    CHECK(session.registered->find(ids[5]) == find("v2"));

    // Of an alias there is no other one.
    request.nodes_to_register = {ids[0]};
    RegisterNodesResponse again;
    REQUIRE(register_nodes(view, request, again) == status::Good);
    CHECK(again.registered_node_ids == request.nodes_to_register);

    UnregisterNodesRequest end;
    end.nodes_to_unregister = {ids[0], node("v2")};
    CHECK(unregister_nodes(view, end) == status::Good);
    CHECK(session.registered->find(ids[0]) == model::no_node);
    CHECK(session.registered->find(ids[5]) == find("v2"));
}

TEST_CASE_METHOD(ViewFixture, "a RegisterNodes that fails on its way leaves no alias")
{
    add_children(5);
    RegisterNodesRequest request;
    for (int i = 0; i < 5; ++i) {
        request.nodes_to_register.push_back(node("v" + std::to_string(i)));
    }
    RegisterNodesResponse response;
    server::detail::ViewContext view = context();
    view.turn = server::detail::Turn{20};
    REQUIRE(server::detail::RegisterWork::begin(view, request, response) == status::Good);
    CHECK_FALSE(server::detail::RegisterWork::go_on(view, request, response));
    REQUIRE(response.registered_node_ids.size() == 2);
    CHECK(session.registered->find(response.registered_node_ids[1]) == find("v1"));
    server::detail::RegisterWork::undo(session, response);
    CHECK(session.registered->find(response.registered_node_ids[1]) == model::no_node);
    CHECK(session.registered->missing(2) == 0);
}

TEST_CASE_METHOD(ViewFixture, "who cannot pay for aliases uses NodeIds")
{
    add_children(2);
    RegisterNodesRequest request;
    request.nodes_to_register = {node("v0"), node("v1")};
    RegisterNodesResponse response;
    server::detail::ViewContext view = context();
    for (std::size_t bytes = 1U << 20U; bytes != 0; bytes /= 2) {
        static_cast<void>(session.charge(bytes)); // all of what it has, in the end
    }
    REQUIRE(register_nodes(view, request, response) == status::Good);
    CHECK(response.registered_node_ids == request.nodes_to_register);
    CHECK(session.registered == nullptr);
    session.release(sizeof(RegisteredNodes) + 2 * RegisteredNodes::place_memory);
    REQUIRE(register_nodes(view, request, response) == status::Good);
    CHECK(RegisteredNodes::is_alias(response.registered_node_ids[1]));
    CHECK_FALSE(session.charge(1));
    // Places that were given back cost nothing.
    UnregisterNodesRequest end;
    end.nodes_to_unregister = response.registered_node_ids;
    CHECK(unregister_nodes(view, end) == status::Good);
    REQUIRE(register_nodes(view, request, response) == status::Good);
    CHECK(RegisteredNodes::is_alias(response.registered_node_ids[0]));
}

namespace {

/// A client with an alias of the Variable "speed".
struct AliasFixture : SubscriptionFixture {
    static Array<NodeId> register_nodes(TestClient& client, const NodeId& node)
    {
        RegisterNodesRequest request;
        request.nodes_to_register = {node, NodeId{0, id::Server}};
        const auto response = client.call<RegisterNodesResponse>(request);
        REQUIRE(response);
        return response->registered_node_ids;
    }
    static DataValue read(TestClient& client, const NodeId& node,
                          AttributeId attribute = AttributeId::Value)
    {
        ReadRequest request;
        request.timestamps_to_return = TimestampsToReturn::Neither;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = node;
        request.nodes_to_read[0].attribute_id = static_cast<std::uint32_t>(attribute);
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    static StatusCode write(TestClient& client, const NodeId& node, std::int32_t value)
    {
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = node;
        request.nodes_to_write[0].attribute_id = 13;
        request.nodes_to_write[0].value.value = Variant{value};
        const auto response = client.call<WriteResponse>(request);
        return response ? response->results[0] : response.error();
    }

    NodeId node{add_writable()};
    TestClient client{log_in_as("operator")};
    NodeId alias{register_nodes(client, node)[0]};

private:
    NodeId add_writable()
    {
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Int32};
        variable.value = Variant{std::int32_t{7}};
        variable.access_level = model::Access::ReadWrite;
        return add_variable("speed", variable);
    }
};

} // namespace

TEST_CASE_METHOD(AliasFixture, "an alias is read and written as its node, until it is given back",
                 "[unit:View RegisterNodes]")
{
    REQUIRE(RegisteredNodes::is_alias(alias));
    CHECK(read(client, alias).value == Variant{std::int32_t{7}});
    CHECK(read(client, alias, AttributeId::NodeId).value == Variant{node});
    CHECK(write(client, alias, 9) == status::Good);
    CHECK(read(client, node).value == Variant{std::int32_t{9}});
    log.keeps_records = true;
    CHECK(write(client, alias, 8) == status::Good);
    // Part 4, 5.9.5.1: records have the NodeId of the node.
    CHECK(log.node_ids == std::vector{to_string(node)});
    CHECK(read(client, node).value == Variant{std::int32_t{8}});

    auto other = log_in_as("operator");
    CHECK(read(other, alias).status == status::Bad_NodeIdUnknown);
    CHECK(write(other, alias, 9) == status::Bad_NodeIdUnknown);

    UnregisterNodesRequest end;
    end.nodes_to_unregister = {alias};
    CHECK(client.status_of<UnregisterNodesResponse>(end) == status::Good);
    CHECK(read(client, alias).status == status::Bad_NodeIdUnknown);
    CHECK(write(client, alias, 9) == status::Bad_NodeIdUnknown);
    CHECK(read(client, node).value == Variant{std::int32_t{8}});
}

TEST_CASE_METHOD(AliasFixture, "what a Write by alias means is told as by NodeId")
{
    model::NewNode property;
    property.id = NodeId{1, "range"};
    property.browse_name = QualifiedName{0, "EURange"};
    property.parent = server.address_space().find(node);
    property.reference_type = NodeId{0, id::HasProperty};
    model::NewVariable range;
    range.data_type = NodeId{0, id::Int32};
    range.value = Variant{std::int32_t{100}};
    range.access_level = model::Access::ReadWrite;
    REQUIRE(server.address_space().add_variable(property, range));
    const NodeId alias_of_range = register_nodes(client, property.id)[0];
    REQUIRE(RegisteredNodes::is_alias(alias_of_range));
    const std::uint32_t subscription = subscribe(client);
    REQUIRE(monitor(client, subscription, item_request(node)).status_code == status::Good);
    CHECK(write(client, alias_of_range, 200) == status::Good);
    const auto waiting = publish(client);
    advance(std::chrono::milliseconds{100}, client);
    const auto published = take(client, waiting);
    REQUIRE(published);
    const auto values = data(published->notification_message);
    REQUIRE(values.size() == 1);
    CHECK(values[0].value.status == StatusCode{0x4000}); // SemanticsChanged
}

TEST_CASE_METHOD(AliasFixture, "an alias of a node that was removed is of no node")
{
    model::AddressSpace& space = server.address_space();
    REQUIRE(space.remove(space.find(node)));
    CHECK(read(client, alias).status == status::Bad_NodeIdUnknown);
    add_variable("other", Variant{std::int32_t{1}});
    CHECK(read(client, alias).status == status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(AliasFixture, "other services take an alias and keep the NodeId of its node")
{
    BrowseRequest browse;
    browse.nodes_to_browse.resize(1);
    browse.nodes_to_browse[0].node_id = alias;
    browse.nodes_to_browse[0].browse_direction = BrowseDirection::Both;
    const auto browsed = client.call<BrowseResponse>(browse);
    REQUIRE(browsed);
    CHECK(browsed->results[0].status_code == status::Good);
    CHECK(browsed->results[0].references.size() == 2); // its parent and its type

    TranslateBrowsePathsToNodeIdsRequest translate;
    translate.browse_paths.resize(1);
    translate.browse_paths[0].starting_node = alias;
    translate.browse_paths[0].relative_path.elements.resize(1);
    RelativePathElement& up = translate.browse_paths[0].relative_path.elements[0];
    up.reference_type_id = NodeId{0, id::HierarchicalReferences};
    up.include_subtypes = true;
    up.is_inverse = true;
    up.target_name = QualifiedName{0, "Objects"};
    const auto translated = client.call<TranslateBrowsePathsToNodeIdsResponse>(translate);
    REQUIRE(translated);
    CHECK(translated->results[0].status_code == status::Good);

    // The item outlives the alias.
    const std::uint32_t subscription = subscribe(client);
    CHECK(monitor(client, subscription, item_request(alias)).status_code == status::Good);
    UnregisterNodesRequest end;
    end.nodes_to_unregister = {alias};
    CHECK(client.status_of<UnregisterNodesResponse>(end) == status::Good);
    const auto waiting = publish(client);
    advance(std::chrono::milliseconds{100}, client);
    const auto published = take(client, waiting);
    REQUIRE(published);
    const auto values = data(published->notification_message);
    REQUIRE(values.size() == 1);
    CHECK(values[0].value.value == Variant{std::int32_t{7}});
}

} // namespace registered_nodes_test

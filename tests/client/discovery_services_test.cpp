#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include <busbar/client/discovery.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/discovery.hpp>

#include "scripted_requester.hpp"

namespace discovery_services_test {

using namespace busbar;
using namespace busbar::client;
using Sizes = std::vector<std::size_t>;

namespace {

/// A server that registers nodes as others, a few at a time, and keeps what it was asked.
struct RegisteringServer {
    RegisteringServer()
    {
        requester.on<RegisterNodesRequest, RegisterNodesResponse>(
            [this](const RegisterNodesRequest& request) -> Result<RegisterNodesResponse> {
                const auto& nodes = request.nodes_to_register;
                asked.push_back(nodes.size());
                if (nodes.size() > most) {
                    return fail(refusal);
                }
                RegisterNodesResponse response;
                for (const NodeId& node : nodes) {
                    response.registered_node_ids.push_back(NodeId{9, node.numeric()});
                }
                return response;
            });
        requester.on<UnregisterNodesRequest, UnregisterNodesResponse>(
            [this](const UnregisterNodesRequest& request) -> Result<UnregisterNodesResponse> {
                asked.push_back(request.nodes_to_unregister.size());
                if (request.nodes_to_unregister.size() > most) {
                    return fail(refusal);
                }
                return UnregisterNodesResponse{};
            });
    }
    [[nodiscard]] static std::vector<NodeId> nodes(std::uint32_t count)
    {
        std::vector<NodeId> nodes;
        for (std::uint32_t i = 1; i <= count; ++i) {
            nodes.push_back(NodeId{2, i});
        }
        return nodes;
    }
    void register_some(std::uint32_t count)
    {
        register_nodes(requester, nodes(count),
                       [this](std::vector<Result<NodeId>> all) { registered = std::move(all); });
        REQUIRE(requester.run());
        REQUIRE(registered.size() == count);
    }
    void unregister_some(std::uint32_t count)
    {
        unregister_nodes(requester, nodes(count),
                         [this](std::vector<StatusCode> all) { unregistered = std::move(all); });
        REQUIRE(requester.run());
        REQUIRE(unregistered.size() == count);
    }

    test::ScriptedRequester requester;
    std::size_t most{1'000};
    StatusCode refusal{status::Bad_TooManyOperations};
    Sizes asked;
    std::vector<Result<NodeId>> registered;
    std::vector<StatusCode> unregistered;
};

} // namespace

TEST_CASE_METHOD(RegisteringServer, "Nodes are registered in calls of the server's size")
{
    requester.info.operation_limits.max_nodes_per_register_nodes = 2;
    register_some(5);
    CHECK(asked == Sizes{2, 2, 1});
    for (std::uint32_t i = 0; i < 5; ++i) {
        CHECK(registered[i] == NodeId{9, i + 1});
    }
    asked.clear();
    unregister_some(5);
    CHECK(asked == Sizes{2, 2, 1});
    CHECK(unregistered == std::vector<StatusCode>(5));
}

TEST_CASE_METHOD(RegisteringServer, "Nodes are not registered twice")
{
    most = 2;
    SECTION("but in parts, if nothing was done")
    {
        register_some(4);
        CHECK(asked == Sizes{4, 2, 2});
        CHECK(registered[3] == NodeId{9, 4});
    }
    SECTION("as they may be registered though the answer is too large")
    {
        refusal = status::Bad_ResponseTooLarge;
        register_some(4);
        CHECK(asked == Sizes{4});
        CHECK(registered[3] == fail(status::Bad_ResponseTooLarge));
        // Unregistering them twice does no harm.
        asked.clear();
        unregister_some(4);
        CHECK(asked == Sizes{4, 2, 2});
        CHECK(unregistered[3] == status::Good);
    }
    SECTION("nor one by one, if nobody may")
    {
        refusal = status::Bad_UserAccessDenied;
        register_some(3);
        unregister_some(3);
        CHECK(asked == Sizes{3, 3});
        CHECK(registered[0] == fail(status::Bad_UserAccessDenied));
        CHECK(unregistered[2] == status::Bad_UserAccessDenied);
    }
}

TEST_CASE_METHOD(RegisteringServer, "A server that names too few registered nodes names none")
{
    requester.on<RegisterNodesRequest, RegisterNodesResponse>([](const RegisterNodesRequest&) {
        RegisterNodesResponse response;
        response.registered_node_ids.push_back(NodeId{9, 1});
        return response;
    });
    register_some(2);
    CHECK(registered[0] == fail(status::Bad_UnknownResponse));
    CHECK(registered[1] == fail(status::Bad_UnknownResponse));
}

TEST_CASE("Servers are found by what they are asked for")
{
    test::ScriptedRequester requester;
    requester.on<FindServersRequest, FindServersResponse>([](const FindServersRequest& request) {
        FindServersResponse response;
        for (const String& uri : request.server_uris) {
            response.servers.emplace_back().application_uri = uri;
        }
        response.servers.emplace_back().application_uri = request.endpoint_url;
        return response;
    });
    std::vector<std::string> found;
    find_servers(requester, "opc.tcp://plc:4840",
                 [&](Result<std::vector<ApplicationDescription>> servers) {
                     REQUIRE(servers);
                     for (const ApplicationDescription& server : *servers) {
                         found.push_back(server.application_uri.str());
                     }
                 },
                 {"urn:a", "urn:b"});
    CHECK(found.empty()); // not from within the call
    REQUIRE(requester.run());
    CHECK(found == std::vector<std::string>{"urn:a", "urn:b", "opc.tcp://plc:4840"});
}

TEST_CASE("Servers on the network are found behind a record")
{
    test::ScriptedRequester requester;
    FindServersOnNetworkRequest asked;
    requester.on<FindServersOnNetworkRequest, FindServersOnNetworkResponse>(
        [&](const FindServersOnNetworkRequest& request) {
            asked = request;
            FindServersOnNetworkResponse response;
            response.servers.emplace_back().record_id = request.starting_record_id + 1;
            return response;
        });
    std::uint32_t record = 0;
    find_servers_on_network(
        requester,
        [&](Result<FindServersOnNetworkResponse> response) {
            REQUIRE(response);
            record = response->servers.begin()->record_id;
        },
        {"DA", "HD"}, 7, 3);
    REQUIRE(requester.run());
    CHECK(record == 8);
    CHECK(asked.max_records_to_return == 3);
    CHECK(asked.server_capability_filter == Array<String>{"DA", "HD"});
}

TEST_CASE("Discovery that is refused says why")
{
    test::ScriptedRequester requester; // knows none of the services
    std::vector<StatusCode> told;
    const auto keep = [&](const auto& result) {
        REQUIRE_FALSE(result);
        told.push_back(result.error());
    };
    find_servers(requester, "opc.tcp://plc:4840", keep);
    find_servers_on_network(requester, keep);
    get_endpoints(requester, "opc.tcp://plc:4840", keep);
    REQUIRE(requester.run());
    CHECK(told == std::vector<StatusCode>(3, status::Bad_ServiceUnsupported));
}

TEST_CASE("A tree without a root is whole, and told of later")
{
    test::ScriptedRequester requester;
    int told = 0;
    const std::vector<NodeId> roots;
    Operation operation =
        browse_tree(requester, roots, children_of({}), [&](const BrowsedTree& tree) {
            ++told;
            CHECK(tree.is_complete);
            CHECK(tree.nodes.empty());
        });
    CHECK(told == 0);
    SECTION("unless nobody wants it any more")
    {
        operation.cancel();
        REQUIRE(requester.run());
        CHECK(told == 0);
    }
    SECTION("once")
    {
        REQUIRE(requester.run());
        CHECK(told == 1);
    }
    CHECK(requester.sent() == 0);
}

TEST_CASE("A tree has what could be browsed, and says what could not")
{
    test::ScriptedRequester requester;
    requester.on<BrowseRequest, BrowseResponse>([](const BrowseRequest& request) {
        BrowseResponse response;
        for (const BrowseDescription& item : request.nodes_to_browse) {
            BrowseResult& result = response.results.emplace_back();
            const std::uint32_t number = item.node_id.numeric();
            if (number == 2) {
                result.status_code = status::Bad_UserAccessDenied;
            } else if (number == 1) {
                result.references.emplace_back().node_id = NodeId{2, 2};
                result.references.emplace_back().node_id = NodeId{2, 3};
            }
        }
        return response;
    });
    BrowsedTree tree;
    const auto keep = [&](BrowsedTree browsed) { tree = std::move(browsed); };
    // The root is there once, though it is named twice.
    browse_tree(requester, {NodeId{2, 1}, NodeId{2, 1}}, children_of({}), keep);
    REQUIRE(requester.run());
    REQUIRE(tree.nodes.size() == 3);
    CHECK_FALSE(tree.is_complete);
    CHECK(tree.nodes[0].status == status::Good);
    CHECK(tree.nodes[1].status == status::Bad_UserAccessDenied);
    CHECK(tree.nodes[2].status == status::Good);
    CHECK(tree.nodes[2].parent == 0);
    // What is cancelled is not told, whatever has been browsed.
    tree = {};
    Operation operation = browse_tree(requester, {NodeId{2, 1}}, children_of({}), keep);
    REQUIRE(requester.step());
    operation.cancel();
    REQUIRE(requester.run());
    CHECK(tree.nodes.empty());
}

} // namespace discovery_services_test

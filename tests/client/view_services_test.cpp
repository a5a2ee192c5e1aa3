#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/client/attributes.hpp>
#include <busbar/client/discovery.hpp>
#include <busbar/client/node_address.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/ids.hpp>

#include "scripted_requester.hpp"
#include "server_requester.hpp"

namespace busbar::client::view_services_test {

namespace {

using busbar::test::ScriptedRequester;

/// A server whose nodes have so many children each, given a few at a time.
struct BrowseFixture {
    BrowseFixture()
    {
        requester.on<BrowseRequest, BrowseResponse>([this](const BrowseRequest& request) {
            BrowseResponse response;
            for (const BrowseDescription& item : request.nodes_to_browse) {
                ++browsed;
                response.results.push_back(answer(item.node_id, 0));
            }
            return response;
        });
        requester.on<BrowseNextRequest, BrowseNextResponse>([this](const BrowseNextRequest& r) {
            BrowseNextResponse response;
            for (const ByteString& point : r.continuation_points) {
                response.results.push_back(next(point, r.release_continuation_points));
            }
            return response;
        });
    }
    BrowseResult next(const ByteString& point, bool releases)
    {
        const auto found = points.find(point);
        if (found == points.end()) {
            return {status::Bad_ContinuationPointInvalid, {}, {}};
        }
        const auto [node, from] = found->second;
        points.erase(found);
        return releases ? BrowseResult{} : answer(node, from);
    }
    BrowseResult answer(const NodeId& node, std::uint32_t from)
    {
        BrowseResult result;
        const std::uint32_t end =
            is_endless ? from + per_answer : std::min(from + per_answer, children);
        for (std::uint32_t i = from; i < end; ++i) {
            ReferenceDescription reference;
            reference.node_id = NodeId{3, node.numeric() * 1'000 + i};
            result.references.push_back(std::move(reference));
        }
        if (is_endless || end < children) {
            if (points.size() == max_points) {
                return {status::Bad_NoContinuationPoints, {}, {}};
            }
            const std::byte bytes[] = {std::byte(++last_point), std::byte(last_point >> 8U)};
            result.continuation_point = ByteString{bytes};
            points[result.continuation_point] = {node, end};
        }
        return result;
    }
    Operation browse_all(std::uint32_t count, BrowseLimits limits = {})
    {
        std::vector<BrowseDescription> nodes;
        for (std::uint32_t i = 0; i < count; ++i) {
            nodes.push_back(children_of(NodeId{2, i}));
        }
        return browse(
            requester, std::move(nodes),
            [this](std::vector<BrowseResult> r) {
                results = std::move(r);
                ++done;
            },
            limits);
    }

    ScriptedRequester requester;
    std::uint32_t children{10};
    std::uint32_t per_answer{3};
    bool is_endless{false};
    std::size_t max_points{1'000};
    std::map<ByteString, std::pair<NodeId, std::uint32_t>> points;
    unsigned last_point{0};
    int browsed{0};
    std::vector<BrowseResult> results;
    int done{0};
};

/// A server where each path leads to the node of its last name, but for some.
struct ResolveFixture {
    ResolveFixture()
    {
        requester.on<TranslateBrowsePathsToNodeIdsRequest, TranslateBrowsePathsToNodeIdsResponse>(
            [this](const TranslateBrowsePathsToNodeIdsRequest& request) {
                TranslateBrowsePathsToNodeIdsResponse response;
                for (const BrowsePath& path : request.browse_paths) {
                    paths.push_back(path);
                    response.results.push_back(
                        answer(path.relative_path.elements.back().target_name.name));
                }
                return response;
            });
    }
    [[nodiscard]] static BrowsePathResult answer(const String& name)
    {
        const BrowsePathTarget target{NodeId{2, name}, UINT32_MAX};
        if (name.view() == "two") {
            return {status::Good, {target, target}};
        }
        if (name.view() == "far") {
            return {status::Good, {BrowsePathTarget{NodeId{2, name}, 1}}};
        }
        return name.view() == "none" ? BrowsePathResult{status::Bad_NoMatch, {}}
                                     : BrowsePathResult{status::Good, {target}};
    }
    void resolved(const std::vector<const char*>& texts)
    {
        std::vector<NodeAddress> addresses;
        for (const char* text : texts) {
            addresses.push_back(NodeAddress::parse(text).value());
        }
        ids.clear();
        resolve(requester, addresses, [&](std::vector<Result<NodeId>> r) { ids = std::move(r); });
        CHECK(ids.empty());
        REQUIRE(requester.run());
        REQUIRE(ids.size() == texts.size());
    }

    ScriptedRequester requester;
    std::vector<BrowsePath> paths;
    std::vector<Result<NodeId>> ids;
};

} // namespace

TEST_CASE_METHOD(BrowseFixture, "Browse goes on until there is no more",
                 "[unit:View Client Basic Browse][unit:Address Space Client Base]")
{
    browse_all(3);
    REQUIRE(requester.run());
    REQUIRE(done == 1);
    for (const BrowseResult& result : results) {
        CHECK(result.status_code == status::Good);
        CHECK(result.references.size() == 10);
        CHECK(result.continuation_point.is_null());
    }
    CHECK(results[2].references[9].node_id == ExpandedNodeId{NodeId{3, 2'009}});
    CHECK(points.empty());
}

TEST_CASE_METHOD(BrowseFixture, "Nodes wait for continuation points that others use")
{
    max_points = 2;
    browse_all(7);
    REQUIRE(requester.run());
    REQUIRE(done == 1);
    for (const BrowseResult& result : results) {
        CHECK(result.status_code == status::Good);
        CHECK(result.references.size() == 10);
    }
    CHECK(browsed <= 7 + 5 + 3 + 3);

    max_points = 0;
    browse_all(5);
    REQUIRE(requester.run());
    CHECK(done == 2);
    CHECK(results[4].status_code == status::Bad_NoContinuationPoints);
}

TEST_CASE_METHOD(BrowseFixture, "An endless Browse ends at the limits, with nothing left behind")
{
    is_endless = true;
    BrowseLimits limits;
    SECTION("of references of a node")
    {
        limits.max_references_per_node = 100;
        browse_all(2, limits);
        REQUIRE(requester.run());
        CHECK(results[1].references.size() == 100);
    }
    SECTION("of references of all")
    {
        limits.max_references = 50;
        browse_all(2, limits);
        REQUIRE(requester.run());
        CHECK(results[0].references.size() + results[1].references.size() == 50);
    }
    SECTION("of empty answers")
    {
        per_answer = 0;
        browse_all(1, limits);
        REQUIRE(requester.run());
        CHECK(results[0].references.empty());
        CHECK(requester.sent() < 20);
    }
    REQUIRE(done == 1);
    CHECK(results[0].status_code == status::Uncertain_NotAllNodesAvailable);
    CHECK(points.empty());
}

TEST_CASE_METHOD(BrowseFixture, "A node whose continuation point was freed is browsed again")
{
    browse_all(2);
    requester.step();
    points.clear();
    REQUIRE(requester.run());
    CHECK(results[1].status_code == status::Good);
    CHECK(results[1].references.size() == 10);

    // Of a server that never keeps one, there is what comes first.
    requester.on<BrowseNextRequest, BrowseNextResponse>([](const BrowseNextRequest& request) {
        BrowseNextResponse response;
        for (std::size_t i = 0; i < request.continuation_points.size(); ++i) {
            response.results.push_back({status::Bad_ContinuationPointInvalid, {}, {}});
        }
        return response;
    });
    browse_all(3);
    REQUIRE(requester.run());
    CHECK(done == 2);
    CHECK(results[1].status_code == status::Uncertain_NotAllNodesAvailable);
    CHECK(results[1].references.size() == 3);
}

TEST_CASE_METHOD(BrowseFixture, "A cancelled Browse releases its continuation points")
{
    const int steps = GENERATE(0, 1, 2, 3, 4);
    requester.info.operation_limits.max_nodes_per_browse = 2;
    Operation operation = browse_all(31);
    for (int i = 0; i < steps; ++i) {
        requester.step();
    }
    operation.cancel();
    REQUIRE(requester.run());
    CHECK(done == 0);
    CHECK(points.empty());
    CHECK(browsed < 31);
}

TEST_CASE_METHOD(BrowseFixture, "A tree is walked once around its cycles and no deeper than asked")
{
    requester.on<BrowseRequest, BrowseResponse>([](const BrowseRequest& request) {
        BrowseResponse response;
        for (const BrowseDescription& item : request.nodes_to_browse) {
            // Each node has its double and its successor below it, and all have the first.
            BrowseResult& result = response.results.emplace_back();
            const std::uint32_t n = item.node_id.numeric();
            for (const std::uint32_t child : {1U, n * 2, n + 1}) {
                result.references.emplace_back().node_id = NodeId{2, child};
            }
            result.references.emplace_back().node_id = ExpandedNodeId{NodeId{2, 1}, {}, 1};
        }
        return response;
    });
    BrowsedTree tree;
    const auto walk = [&](TreeLimits limits) {
        browse_tree(
            requester, {NodeId{2, 1}}, children_of({}), [&](BrowsedTree t) { tree = std::move(t); },
            limits);
        REQUIRE(requester.run());
    };
    TreeLimits limits;
    limits.max_depth = 3;
    walk(limits);
    CHECK_FALSE(tree.is_complete);
    REQUIRE(tree.nodes.size() == 1 + (1 + 1) + 2 + 3);
    CHECK(tree.nodes[0].parent == TreeNode::no_parent);
    CHECK(tree.nodes.back().depth == 3);
    limits.max_depth = 1'000;
    limits.max_nodes = 50;
    walk(limits);
    CHECK(tree.nodes.size() == 50);
    CHECK_FALSE(tree.is_complete);
}

TEST_CASE_METHOD(ResolveFixture, "Addresses are resolved with as few requests as it takes")
{
    resolved({"i=2258", "nsu=urn:acme;s=Pump", "nsu=urn:else;s=Pump", "svr=1;i=5"});
    CHECK(requester.sent() == 0);
    CHECK(ids[0] == NodeId{0, 2258});
    CHECK(ids[1] == NodeId{2, "Pump"});
    CHECK(ids[2] == fail(status::Bad_NodeIdUnknown));
    CHECK(ids[3] == fail(status::Bad_ServerIndexInvalid));

    resolved({"/Objects/nsu=urn:acme;Speed", "i=1", "[nsu=urn:acme;i=7]<HasComponent>two", "/none",
              "/far", "/nsu=urn:else;x"});
    CHECK(requester.sent() == 2); // "none" might be of another namespace
    CHECK(ids[0] == NodeId{2, "Speed"});
    CHECK(ids[1] == NodeId{0, 1});
    CHECK(ids[2] == fail(status::Bad_TooManyMatches));
    CHECK(ids[3] == fail(status::Bad_NoMatch));
    CHECK(ids[4] == fail(status::Bad_NoMatch));
    CHECK(ids[5] == fail(status::Bad_NodeIdUnknown));
    REQUIRE(paths.size() == 4);
    CHECK(paths[0].starting_node == NodeId{0, id::RootFolder});
    CHECK(paths[0].relative_path.elements[1].target_name == QualifiedName{2, "Speed"});
    CHECK(paths[1].starting_node == NodeId{2, 7});
}

TEST_CASE_METHOD(ResolveFixture, "ReferenceTypes of the server are looked up once")
{
    requester.on<BrowseRequest, BrowseResponse>([](const BrowseRequest& request) {
        BrowseResponse response;
        response.results.resize(request.nodes_to_browse.size());
        if (request.nodes_to_browse[0].node_id.is(id::References)) {
            ReferenceDescription& type = response.results[0].references.emplace_back();
            type.node_id = NodeId{2, 50};
            type.browse_name = {2, "Feeds"};
        }
        return response;
    });
    resolved({"/a<2:Feeds>b", "/a<2:Unknown>b"});
    CHECK(ids[0] == NodeId{2, "b"});
    CHECK(ids[1] == fail(status::Bad_ReferenceTypeIdInvalid));
    CHECK(paths.back().relative_path.elements[1].reference_type_id == NodeId{2, 50});
}

TEST_CASE_METHOD(ResolveFixture, "Before the first session a request waits for it")
{
    requester.info = {};
    resolved({"nsu=urn:acme;s=Pump"});
    CHECK(ids[0] == fail(status::Bad_ServiceUnsupported));
    requester.on<ReadRequest, ReadResponse>([&](const ReadRequest&) {
        requester.info.namespaces = {"http://opcfoundation.org/UA/", "urn:acme"};
        ReadResponse response;
        response.results.resize(1);
        return response;
    });
    resolved({"nsu=urn:acme;s=Pump"});
    CHECK(ids[0] == NodeId{1, "Pump"});
}

TEST_CASE("The services work with a server", "[unit:Discovery Client Find Servers Basic]")
{
    test::ServerFixture fixture;
    test::ServerRequester requester{fixture.log_in()};
    requester.info.operation_limits.max_nodes_per_browse = 7;
    requester.info.operation_limits.max_nodes_per_read = 50;
    BrowsedTree tree;
    TreeLimits limits;
    limits.browse.references_per_answer = 2;
    browse_tree(
        requester, {NodeId{0, id::ObjectsFolder}}, children_of({}),
        [&](BrowsedTree t) { tree = std::move(t); }, limits);
    requester.run();
    CHECK(tree.is_complete);
    CHECK(tree.nodes.size() > 20);

    std::vector<NodeAddress> nodes;
    for (const TreeNode& node : tree.nodes) {
        nodes.push_back(node.reference.node_id.node_id);
    }
    nodes.push_back(NodeAddress::parse("/Objects/Server/ServerStatus<HasComponent>State").value());
    nodes.push_back(NodeAddress::parse("/Objects/None").value());
    std::vector<DataValue> names;
    read(
        requester, nodes, [&](std::vector<DataValue> v) { names = std::move(v); },
        AttributeId::BrowseName);
    requester.run();
    REQUIRE(names.size() == nodes.size());
    CHECK(names.front().value == Variant{QualifiedName{0, "Objects"}});
    CHECK(names[names.size() - 2].value == Variant{QualifiedName{0, "State"}});
    CHECK(names.back().status == status::Bad_NoMatch);

    std::size_t endpoints = 0;
    get_endpoints(
        requester, "opc.tcp://localhost:4840",
        [&](const Result<std::vector<EndpointDescription>>& r) { endpoints = r.value().size(); });
    std::string server;
    find_servers(requester, "opc.tcp://localhost:4840",
                 [&](const Result<std::vector<ApplicationDescription>>& r) {
                     server = r.value().at(0).application_uri.str();
                 });
    requester.run();
    CHECK(endpoints > 1);
    CHECK(server == "urn:busbar:test:server");
}

} // namespace busbar::client::view_services_test

#include <catch2/catch.hpp>

#include <map>

#include <busbar/client/resolve_nodes.hpp>
#include <busbar/types/ids.hpp>

#include "scripted_requester.hpp"

namespace busbar::client::path_search_test {

namespace {

/// A server whose nodes are what the test says, and which translates paths as they are.
struct PathServer {
    using Children = std::vector<std::pair<QualifiedName, NodeId>>;

    PathServer()
    {
        requester.on<TranslateBrowsePathsToNodeIdsRequest, TranslateBrowsePathsToNodeIdsResponse>(
            [this](const TranslateBrowsePathsToNodeIdsRequest& request) {
                TranslateBrowsePathsToNodeIdsResponse response;
                for (const BrowsePath& path : request.browse_paths) {
                    response.results.push_back(translate(path));
                }
                return response;
            });
        requester.on<BrowseRequest, BrowseResponse>([this](const BrowseRequest& request) {
            BrowseResponse response;
            for (const BrowseDescription& item : request.nodes_to_browse) {
                ++browsed;
                response.results.push_back(browse_one(item.node_id));
            }
            return response;
        });
    }
    [[nodiscard]] BrowsePathResult translate(const BrowsePath& path) const
    {
        NodeId node = path.starting_node;
        for (const RelativePathElement& element : path.relative_path.elements) {
            const auto found = nodes.find(node);
            const Children none;
            const Children& children = found == nodes.end() ? none : found->second;
            const auto child =
                std::ranges::find(children, element.target_name, &Children::value_type::first);
            if (child == children.end()) {
                return {status::Bad_NoMatch, {}};
            }
            node = child->second;
        }
        return {status::Good, {BrowsePathTarget{node, UINT32_MAX}}};
    }
    [[nodiscard]] BrowseResult browse_one(const NodeId& node) const
    {
        BrowseResult result;
        const auto found = nodes.find(node);
        if (found == nodes.end()) {
            return result;
        }
        for (const auto& [name, target] : found->second) {
            ReferenceDescription& reference = result.references.emplace_back();
            reference.node_id = target;
            reference.browse_name = name;
        }
        return result;
    }
    [[nodiscard]] ResolvedNode resolved(const char* text)
    {
        std::vector<ResolvedNode> results;
        resolve_nodes(requester, {NodeAddress::parse(text).value()},
                      [&](std::vector<ResolvedNode> found) { results = std::move(found); });
        REQUIRE(requester.run());
        REQUIRE(results.size() == 1);
        return results.front();
    }

    test::ScriptedRequester requester;
    std::map<NodeId, Children> nodes{
        {NodeId{0, id::RootFolder}, {{{0, "Objects"}, NodeId{0, id::ObjectsFolder}}}},
        {NodeId{0, id::ObjectsFolder},
         {{{0, "Server"}, NodeId{0, id::Server}},
          {{2, "Press"}, NodeId{2, "Press"}},
          {{2, "Oven"}, NodeId{2, "Oven"}},
          {{1, "Oven"}, NodeId{1, "Oven"}}}},
        {NodeId{2, "Press"}, {{{1, "Speed"}, NodeId{1, "Speed"}}, {{2, "Force"}, NodeId{2, 7U}}}},
        {NodeId{1, "Oven"}, {{{1, "Heat"}, NodeId{1, "Heat"}}}},
    };
    int browsed{0};
};

using Texts = std::vector<std::string>;

Texts texts(const ResolvedNode& node)
{
    Texts texts;
    for (const NodeAddress& candidate : node.candidates) {
        texts.push_back(candidate.text());
    }
    return texts;
}

} // namespace

TEST_CASE_METHOD(PathServer, "A path needs no namespaces where there is one way only",
                 "[unit:View Client Basic Browse]")
{
    CHECK(resolved("/Objects/Press/Speed").id == NodeId{1, "Speed"});
    CHECK(resolved("/Objects/2:Press/Force").id == NodeId{2, 7U});
    // Each element is looked at, from the start of the path.
    CHECK(browsed == 6);
    CHECK(resolved("[ns=2;s=Press]/Speed").id == NodeId{1, "Speed"});
}

TEST_CASE_METHOD(PathServer, "A path that the server translates is not searched for",
                 "[unit:View Client TranslateBrowsePath]")
{
    CHECK(resolved("/Objects/2:Press/1:Speed").id == NodeId{1, "Speed"});
    CHECK(resolved("/Objects/Server").id == NodeId{0, id::Server});
    CHECK(resolved("/2:Press").id == fail(status::Bad_NoMatch));
    CHECK(browsed == 0);
}

TEST_CASE_METHOD(PathServer, "A name of several namespaces is told with them")
{
    const ResolvedNode oven = resolved("/Objects/Oven/Heat");
    CHECK(oven.id == fail(status::Bad_TooManyMatches));
    CHECK(texts(oven) == Texts{"/Objects/2:Oven/Heat", "/Objects/1:Oven/Heat"});
    CHECK(resolved("/Objects/1:Oven/Heat").id == NodeId{1, "Heat"});
    // That of OPC UA goes before all others.
    nodes[NodeId{0, id::ObjectsFolder}].push_back({{2, "Server"}, NodeId{2, "Server"}});
    nodes[NodeId{0, id::Server}] = {{{2, "Own"}, NodeId{2, "Own"}}};
    CHECK(resolved("/Objects/Server/Own").id == NodeId{2, "Own"});
}

TEST_CASE_METHOD(PathServer, "Candidates have the namespaces that were found on the way")
{
    nodes[NodeId{2, "Press"}].push_back({{3, "Force"}, NodeId{3, "Force"}});
    CHECK(texts(resolved("/Objects/Press<HasComponent>Force.Unit")) ==
          Texts{"/Objects/2:Press<HasComponent>2:Force.Unit",
                "/Objects/2:Press<HasComponent>3:Force.Unit"});
    CHECK(texts(resolved("[ns=2;s=Press]/Force")) ==
          Texts{"[ns=2;s=Press]/2:Force", "[ns=2;s=Press]/3:Force"});
}

TEST_CASE_METHOD(PathServer, "Nodes that have even the namespace in common are told by their ids")
{
    nodes[NodeId{0, id::ObjectsFolder}].push_back({{2, "Oven"}, NodeId{2, "Spare"}});
    CHECK(texts(resolved("/Objects/Oven/Heat")) ==
          Texts{"[ns=2;s=Oven]/Heat", "/Objects/1:Oven/Heat", "[ns=2;s=Spare]/Heat"});
    CHECK(texts(resolved("/Objects/Oven")) ==
          Texts{"ns=2;s=Oven", "/Objects/1:Oven", "ns=2;s=Spare"});
}

TEST_CASE_METHOD(PathServer, "Each candidate is a path that leads to one node")
{
    nodes[NodeId{0, id::ObjectsFolder}].push_back({{2, "Oven"}, NodeId{2, "Spare"}});
    std::vector<Result<NodeId>> found;
    for (const std::string& text : texts(resolved("/Objects/Oven"))) {
        found.push_back(resolved(text.c_str()).id);
    }
    CHECK(found ==
          std::vector<Result<NodeId>>{NodeId{2, "Oven"}, NodeId{1, "Oven"}, NodeId{2, "Spare"}});
}

TEST_CASE_METHOD(PathServer, "Candidates are twenty at most")
{
    for (std::uint16_t ns = 3; ns < 40; ++ns) {
        nodes[NodeId{0, id::ObjectsFolder}].push_back({{ns, "Oven"}, NodeId{ns, "Oven"}});
    }
    const ResolvedNode oven = resolved("/Objects/Oven");
    CHECK(oven.id == fail(status::Bad_TooManyMatches));
    CHECK(oven.candidates.size() == 20);
}

TEST_CASE_METHOD(PathServer, "Several targets that the server tells are the candidates")
{
    requester.on<TranslateBrowsePathsToNodeIdsRequest, TranslateBrowsePathsToNodeIdsResponse>(
        [](const TranslateBrowsePathsToNodeIdsRequest&) {
            TranslateBrowsePathsToNodeIdsResponse response;
            response.results.push_back(
                {status::Good,
                 {BrowsePathTarget{NodeId{2, "Oven"}, UINT32_MAX},
                  BrowsePathTarget{NodeId{2, "Spare"}, UINT32_MAX},
                  BrowsePathTarget{NodeId{2, "Elsewhere"}, 1}}}); // on another server
            return response;
        });
    const ResolvedNode oven = resolved("/Objects/2:Oven");
    CHECK(oven.id == fail(status::Bad_TooManyMatches));
    CHECK(texts(oven) == Texts{"ns=2;s=Oven", "ns=2;s=Spare"});
}

TEST_CASE_METHOD(PathServer, "Two references to one node are one way")
{
    nodes[NodeId{2, "Press"}].push_back({{1, "Speed"}, NodeId{1, "Speed"}});
    CHECK(resolved("/Objects/Press/Speed").id == NodeId{1, "Speed"});
}

TEST_CASE_METHOD(PathServer, "A path to nowhere stays one")
{
    CHECK(resolved("/Objects/Press/None").id == fail(status::Bad_NoMatch));
    CHECK(resolved("/None/Press/Speed").id == fail(status::Bad_NoMatch));
    requester.on<BrowseRequest, BrowseResponse>(
        [](const BrowseRequest&) { return fail(status::Bad_UserAccessDenied); });
    CHECK(resolved("/Objects/Press/Speed").id == fail(status::Bad_NoMatch));
}

} // namespace busbar::client::path_search_test

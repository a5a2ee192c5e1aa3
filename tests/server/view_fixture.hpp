#pragma once

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/types/ids.hpp>

#include "model/model_fixture.hpp"
#include "server/view/browse_work.hpp"
#include "server/view/view_context.hpp"
#include "server/view/view_part.hpp"
#include "support/seeded_random.hpp"

namespace busbar::server::detail {

using Names = std::vector<std::string>;

/// Hides the nodes of one name.
class HidesOne final : public AccessControl {
public:
    explicit HidesOne(NodeId hidden) : hidden_{std::move(hidden)} {}
    [[nodiscard]] bool may_browse(const UserIdentity&, const NodeId& node) const override
    {
        return node != hidden_;
    }
    [[nodiscard]] std::uint8_t user_access_level(const UserIdentity&, const NodeId&,
                                                 std::uint8_t access_level) const override
    {
        return access_level;
    }

private:
    NodeId hidden_;
};

/// As the server does it, however many turns it takes.
template <typename Work, typename Request, typename Response>
StatusCode run_turns(ViewContext& context, const Request& request, Response& response)
{
    Work work;
    const std::size_t units = context.turn.left();
    const StatusCode bad = work.begin(context, request, response);
    while (!bad.is_bad() && !work.go_on(context, request, response)) {
        context.turn = Turn{units};
    }
    return bad;
}
inline StatusCode browse(ViewContext& context, const BrowseRequest& request,
                         BrowseResponse& response)
{
    return run_turns<BrowseWork>(context, request, response);
}
inline StatusCode register_nodes(ViewContext& context, const RegisterNodesRequest& request,
                                 RegisterNodesResponse& response)
{
    response = {};
    return run_turns<RegisterWork>(context, request, response);
}
inline StatusCode unregister_nodes(ViewContext& context, const UnregisterNodesRequest& request)
{
    const StatusCode bad = UnregisterWork::begin(context, request);
    UnregisterWork work;
    while (!bad.is_bad() && !work.go_on(context, request)) {
        context.turn = Turn{1};
    }
    return bad;
}
inline StatusCode browse_next(ViewContext& context, const BrowseNextRequest& request,
                              BrowseNextResponse& response)
{
    return run_turns<BrowseNextWork>(context, request, response);
}

struct ViewFixture : model::ModelFixture {
    ServerLimits limits;
    test::SeededRandom random{1};
    Session session{1U << 20U, 1U << 20U};
    UserIdentity user;
    const AccessControl* control{nullptr};
    model::NodeIndex folder{add_folder("folder", objects)};

    [[nodiscard]] ViewContext context()
    {
        return {space, {space, user, control}, limits, random, session};
    }
    [[nodiscard]] NodeId node(const std::string& name) const { return {ns, String{name}}; }
    void add_children(int count)
    {
        for (int i = 0; i < count; ++i) {
            add_int32("v" + std::to_string(i), folder);
        }
    }
    /// A folder "hub" that organizes `count` more, "same0" and on, all of the BrowseName "same".
    void add_hub(int count)
    {
        const model::NodeIndex hub = add_folder("hub", objects);
        for (int i = 0; i < count; ++i) {
            model::NewNode same =
                named("same" + std::to_string(i), add_folder(std::to_string(i), folder));
            same.browse_name = QualifiedName{ns, "same"};
            const model::NodeIndex added = space.add_folder(same).value();
            REQUIRE(space.add_reference(hub, NodeId{0, id::Organizes}, added));
        }
    }
    [[nodiscard]] static BrowseDescription description(NodeId id)
    {
        BrowseDescription result;
        result.node_id = std::move(id);
        result.reference_type_id = NodeId{0, id::HierarchicalReferences};
        result.include_subtypes = true;
        result.result_mask = static_cast<std::uint32_t>(BrowseResultMask::All);
        return result;
    }
    [[nodiscard]] BrowseResponse browse_all(Array<BrowseDescription> nodes, std::uint32_t most = 0)
    {
        BrowseRequest request;
        request.nodes_to_browse = std::move(nodes);
        request.requested_max_references_per_node = most;
        BrowseResponse response;
        ViewContext view = context();
        REQUIRE(browse(view, request, response) == status::Good);
        return response;
    }
    [[nodiscard]] BrowseResult browse_one(const BrowseDescription& what, std::uint32_t most = 0)
    {
        return browse_all({what}, most).results[0];
    }
    [[nodiscard]] BrowseResult next(const ByteString& point, bool release = false)
    {
        BrowseNextRequest request;
        request.continuation_points = {point};
        request.release_continuation_points = release;
        BrowseNextResponse response;
        ViewContext view = context();
        REQUIRE(browse_next(view, request, response) == status::Good);
        CHECK(response.results.size() == (release ? 0 : 1));
        return release ? BrowseResult{} : response.results[0];
    }
    [[nodiscard]] static Names names(const BrowseResult& result)
    {
        Names all;
        for (const ReferenceDescription& reference : result.references) {
            all.push_back(reference.browse_name.name.str());
        }
        return all;
    }
    [[nodiscard]] static RelativePathElement element(const QualifiedName& name, std::uint32_t type,
                                                     bool is_inverse = false)
    {
        RelativePathElement result;
        result.reference_type_id = type == 0 ? NodeId{} : NodeId{0, type};
        result.include_subtypes = true;
        result.is_inverse = is_inverse;
        result.target_name = name;
        return result;
    }
    [[nodiscard]] BrowsePathResult translate(NodeId start, Array<RelativePathElement> elements)
    {
        TranslateBrowsePathsToNodeIdsRequest request;
        request.browse_paths.emplace_back(
            BrowsePath{std::move(start), RelativePath{std::move(elements)}});
        ViewContext view = context();
        REQUIRE(check_translate(view, request) == status::Good);
        return PathWalk{}.go_on(view, request.browse_paths[0]).value();
    }
};

} // namespace busbar::server::detail

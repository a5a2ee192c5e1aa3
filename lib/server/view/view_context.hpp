#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <busbar/crypto/random.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/limits.hpp>
#include <busbar/types/view.hpp>

#include "server/rights/late_nodes.hpp"
#include "server/rights/node_rights.hpp"
#include "server/session/session.hpp"
#include "server/session/turn.hpp"

namespace busbar::server::detail {

/// What the View services need of the server; as long as that lives.
struct ViewNeeds {
    const model::AddressSpace& space;
    const ServerLimits& limits;
    crypto::Random& random;
    /// May be null.
    const AccessControl* access;
    /// Null if all nodes are there; known once all modules are.
    LateNodes* const& late_nodes;
};

/// What they need of the server and the session for one request.
struct ViewContext {
    /// References that one request is told of.
    static constexpr std::size_t max_references = 200'000;

    const model::AddressSpace& space;
    NodeRights rights;
    const ServerLimits& limits;
    crypto::Random& random;
    Session& session;
    LateNodes* late_nodes{nullptr};
    /// Work and memory of one request.
    std::size_t visits_left{10'000'000};
    std::size_t references_left{max_references};
    /// For so many references results have room, more or fewer than before the turn.
    std::ptrdiff_t room{0};
    /// Bytes of names and NodeIds in what was described.
    std::size_t text_bytes{0};
    /// What may be done of it before others have their turn.
    Turn turn{};
    /// With so many visits left, or none, what looks at references has to stop for now.
    std::size_t pause_at{0};

    [[nodiscard]] bool may_see(model::NodeIndex node) const
    {
        return rights.may_see(node) && rights.check_browse_channel(node).is_good();
    }
    /// The node, if there is one that the user may see; else why there is none for him.
    [[nodiscard]] Result<model::NodeIndex> find(const NodeId& id) const
    {
        model::NodeIndex node =
            session.registered != nullptr ? session.registered->find(id) : model::no_node;
        if (node == model::no_node) {
            node = space.find(id);
        }
        if (node == model::no_node || !rights.may_see(node)) {
            return fail(why_not_found(id));
        }
        if (const StatusCode weak = rights.check_browse_channel(node); weak.is_bad()) {
            return fail(weak);
        }
        return node;
    }
    /// To be called before the references of a node are looked at.
    void add_late_nodes(model::NodeIndex node);
    /// False if it has to stop after this one, for now or because the request has looked at too
    /// much.
    [[nodiscard]] bool visit(std::size_t count)
    {
        visits_left -= count < visits_left ? count : visits_left;
        return may_go_on();
    }
    [[nodiscard]] bool may_go_on() const { return visits_left > pause_at; }
};

/// Good, or why the whole request is refused (Part 4, 5.9.4.3).
[[nodiscard]] StatusCode check_translate(const ViewContext& context,
                                         const TranslateBrowsePathsToNodeIdsRequest& request);

/// One path of a TranslateBrowsePathsToNodeIds (Part 4, 5.9.4) on its way.
class PathWalk {
public:
    /// What it has found or why it ended; nothing if the context's turn is over before that, and it
    /// is to be called again with the same path.
    [[nodiscard]] std::optional<BrowsePathResult> go_on(ViewContext& context,
                                                        const BrowsePath& path);
    /// Bytes that it takes at the moment.
    [[nodiscard]] std::size_t held() const
    {
        return (from_.capacity() + to_.capacity()) * sizeof(model::NodeHandle);
    }

private:
    /// Good at the end of the path, Good_CallAgain if the turn is over.
    [[nodiscard]] StatusCode follow(ViewContext& context, const BrowsePath& path);
    [[nodiscard]] StatusCode begin(const ViewContext& context, const BrowsePath& path);

    bool has_begun_{false};
    std::size_t element_{0};
    /// Nodes that the element is still to be followed from, the next one last.
    std::vector<model::NodeHandle> from_;
    /// Where it has led to.
    std::vector<model::NodeHandle> to_;
};

/// A RegisterNodes (Part 4, 5.9.5) that goes on where its turn ended.
class RegisterWork {
public:
    /// What is wrong with all of the request, if something is. To be called first, once.
    [[nodiscard]] static StatusCode begin(ViewContext& context, const RegisterNodesRequest& request,
                                          RegisterNodesResponse& response);
    /// True once the response is complete; false if the turn is over before.
    [[nodiscard]] static bool go_on(ViewContext& context, const RegisterNodesRequest& request,
                                    RegisterNodesResponse& response);
    /// Gives back the aliases that the response has so far.
    static void undo(Session& session, const RegisterNodesResponse& response);
};

[[nodiscard]] StatusCode unregister_nodes(ViewContext& context,
                                          const UnregisterNodesRequest& request);

} // namespace busbar::server::detail

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <busbar/crypto/random.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/limits.hpp>
#include <busbar/types/view.hpp>

#include "server/rights/live_values.hpp"
#include "server/rights/node_rights.hpp"
#include "server/session/session.hpp"
#include "server/session/turn.hpp"

namespace busbar::server::detail {

/// The needs of the View services; valid as long as the server.
struct ViewNeeds {
    const model::AddressSpace& space;
    const ServerLimits& limits;
    crypto::Random& random;
    /// May be null.
    const AccessControl* access;
    /// Null if all nodes exist already; known once all modules are.
    LateNodes* const& late_nodes;
};

/// The needs of the View services for one request.
struct ViewContext {
    /// Maximum number of references in the response of one request.
    static constexpr std::size_t max_references = 200'000;

    const model::AddressSpace& space;
    NodeRights rights;
    const ServerLimits& limits;
    crypto::Random& random;
    Session& session;
    LateNodes* late_nodes{nullptr};
    /// Keeps the memory of large lists; may be null.
    busbar::detail::KeptMemory* memory{nullptr};
    /// Limits of work and memory of one request.
    std::size_t visits_left{10'000'000};
    std::size_t references_left{max_references};
    /// Number of references that results have room for, relative to the begin of the turn.
    std::ptrdiff_t room{0};
    /// Bytes of names and NodeIds in descriptions.
    std::size_t text_bytes{0};
    /// The work that may be done before others have their turn.
    Turn turn{};
    /// When this many visits are left, or none, visiting references must pause.
    std::size_t pause_at{0};

    [[nodiscard]] bool may_see(model::NodeIndex node) const
    {
        return rights.may_see(node) && rights.check_browse_channel(node).is_good();
    }
    /// Returns the node, if it exists and the user may see it; else the reason for this user.
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
    /// Call it before the references of a node are visited.
    void add_late_nodes(model::NodeIndex node);
    /// Returns false if it must pause after this one, for now or because the request has visited
    /// too many.
    [[nodiscard]] bool visit(std::size_t count)
    {
        visits_left -= count < visits_left ? count : visits_left;
        return may_go_on();
    }
    [[nodiscard]] bool may_go_on() const { return visits_left > pause_at; }
};

/// Returns Good, or why the whole request is refused (Part 4, 5.9.4.3).
[[nodiscard]] StatusCode check_translate(const ViewContext& context,
                                         const TranslateBrowsePathsToNodeIdsRequest& request);

/// One path of a TranslateBrowsePathsToNodeIds (Part 4, 5.9.4) in progress.
class PathWalk {
public:
    /// Returns the result or the reason why it ended; nothing if the context's turn ends before
    /// that, and it must be called again with the same path.
    [[nodiscard]] std::optional<BrowsePathResult> go_on(ViewContext& context,
                                                        const BrowsePath& path);
    /// Bytes that it takes at the moment.
    [[nodiscard]] std::size_t held() const
    {
        return (from_.capacity() + to_.capacity()) * sizeof(model::NodeHandle);
    }

private:
    /// Returns Good at the end of the path, Good_CallAgain if the turn ended.
    [[nodiscard]] StatusCode follow(ViewContext& context, const BrowsePath& path);
    [[nodiscard]] StatusCode begin(const ViewContext& context, const BrowsePath& path);

    bool has_begun_{false};
    std::size_t element_{0};
    /// Nodes that the element must still be followed from, the next one last.
    std::vector<model::NodeHandle> from_;
    /// Nodes that it has led to.
    std::vector<model::NodeHandle> to_;
};

/// A RegisterNodes (Part 4, 5.9.5) that continues where its turn ended.
class RegisterWork {
public:
    /// Returns an error of the whole request, if there is one. Call it first, once.
    [[nodiscard]] static StatusCode begin(ViewContext& context, const RegisterNodesRequest& request,
                                          RegisterNodesResponse& response);
    /// Returns true once the response is complete; false if the turn ends before.
    [[nodiscard]] static bool go_on(ViewContext& context, const RegisterNodesRequest& request,
                                    RegisterNodesResponse& response);
    /// Unregisters the aliases that the response has so far.
    static void undo(Session& session, const RegisterNodesResponse& response);
};

/// An UnregisterNodes (Part 4, 5.9.6) that continues where its turn ended.
class UnregisterWork {
public:
    /// Returns an error of the whole request, if there is one. Call it first, once.
    [[nodiscard]] static StatusCode begin(const ViewContext& context,
                                          const UnregisterNodesRequest& request);
    /// Returns true at the end of the request; false if the turn ends before.
    [[nodiscard]] bool go_on(ViewContext& context, const UnregisterNodesRequest& request);

private:
    std::size_t done_{0};
};

} // namespace busbar::server::detail

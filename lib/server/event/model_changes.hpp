#pragma once

#include <cstddef>

#include <busbar/core/node_id.hpp>

namespace busbar::server::detail {

struct Core;

/// Tells clients of nodes and references that were added and removed, by whomever (Part 3, 9.32),
/// and keeps Server.Namespaces up to date.
class ModelChanges {
public:
    /// Forgets what has happened while the server was made.
    void begin(Core& core);
    /// True if there is something to announce.
    [[nodiscard]] bool is_pending(const Core& core) const;
    /// Gives the nodes that have changed a new NodeVersion and raises one event for all of them.
    void announce(Core& core);

    /// Raises the event for a node whose properties now mean something else (Part 3, 9.33).
    static void announce_semantics(Core& core, const NodeId& node);

private:
    void describe_namespaces(Core& core);

    /// Namespaces that have been looked at.
    std::size_t namespaces_{0};
};

} // namespace busbar::server::detail

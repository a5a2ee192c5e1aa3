#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/log.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

class Events;

/// Tells clients of nodes and references that were added and removed, by whomever (Part 3, 9.32),
/// and keeps Server.Namespaces up to date.
class ModelChangeEvents {
public:
    /// `own_namespace` is the index of the ApplicationUri in the NamespaceArray.
    ModelChangeEvents(model::AddressSpace& space, Events& events, LogSink& log,
                      std::uint16_t own_namespace)
        : space_{space}, events_{events}, log_{log}, own_namespace_{own_namespace}
    {
    }

    /// Forgets what has happened while the server was made.
    void begin();
    /// True if there is something to announce.
    [[nodiscard]] bool is_pending() const;
    /// Gives the nodes that have changed a new NodeVersion and raises one event for all of them.
    void announce();

    /// Raises the event for a node whose properties now mean something else (Part 3, 9.33).
    void announce_semantics(const NodeId& node);

private:
    void describe_namespaces();

    model::AddressSpace& space_;
    Events& events_;
    LogSink& log_;
    std::uint16_t own_namespace_;
    /// Namespaces that have been looked at.
    std::size_t namespaces_{0};
};

} // namespace busbar::server::detail

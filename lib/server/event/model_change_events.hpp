#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/log.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

class Events;

/// Notifies clients of nodes and references that were added and removed, by any code (Part 3,
/// 9.32), and keeps Server.Namespaces up to date.
class ModelChangeEvents {
public:
    /// `own_namespace` is the index of the ApplicationUri in the NamespaceArray.
    ModelChangeEvents(model::AddressSpace& space, Events& events, LogSink& log,
                      std::uint16_t own_namespace)
        : space_{space}, events_{events}, log_{log}, own_namespace_{own_namespace}
    {
    }

    /// Forgets the changes of the server's creation.
    void begin();
    /// True if there is something to announce.
    [[nodiscard]] bool is_pending() const;
    /// Gives the changed nodes a new NodeVersion and raises one event for all of them.
    void announce();

    /// Raises the event for a node whose properties now have another meaning (Part 3, 9.33).
    void announce_semantics(const NodeId& node);

private:
    void describe_namespaces();

    model::AddressSpace& space_;
    Events& events_;
    LogSink& log_;
    std::uint16_t own_namespace_;
    /// Number of namespaces that have been processed.
    std::size_t namespaces_{0};
};

} // namespace busbar::server::detail

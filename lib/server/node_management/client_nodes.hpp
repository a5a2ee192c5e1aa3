#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <unordered_map>

#include <busbar/model/address_space.hpp>
#include <busbar/server/limits.hpp>

namespace busbar::server::detail {

/// The nodes and references that clients have added to the address space, to enforce the limits.
/// Nodes that are removed, by any code, are forgotten with their references.
class ClientNodes {
public:
    ClientNodes() = default;
    ClientNodes(const ClientNodes&) = delete;
    ClientNodes& operator=(const ClientNodes&) = delete;

    [[nodiscard]] bool has_room(const ServerLimits& limits, std::size_t bytes) const
    {
        return node_room(limits) != 0 && bytes <= memory_room(limits);
    }
    [[nodiscard]] std::size_t node_room(const ServerLimits& limits) const
    {
        return limits.max_client_nodes - std::min(nodes_.size(), limits.max_client_nodes);
    }
    [[nodiscard]] std::size_t memory_room(const ServerLimits& limits) const
    {
        return limits.max_client_node_memory - std::min(bytes_, limits.max_client_node_memory);
    }
    void add(const model::AddressSpace& space, model::NodeIndex node, std::size_t bytes);

    [[nodiscard]] bool has_room_for_reference(const ServerLimits& limits) const
    {
        return references_.size() < limits.max_client_references;
    }
    void add_reference(const model::AddressSpace& space, model::NodeIndex source,
                       model::NodeIndex type, model::NodeIndex target);
    void remove_reference(model::NodeIndex source, model::NodeIndex type, model::NodeIndex target)
    {
        references_.erase({source, type, target});
    }

private:
    struct Node final : model::NodeWatch {
        explicit Node(ClientNodes& o) : owner{o} {}
        void node_changed(model::NodeIndex node, bool is_removed) override;

        ClientNodes& owner;
        std::size_t bytes{0};
    };
    /// Source, type and target.
    using ReferenceKey = std::tuple<model::NodeIndex, model::NodeIndex, model::NodeIndex>;
    struct End final : model::NodeWatch {
        End(ClientNodes& o, const ReferenceKey& of) : owner{o}, key{of} {}
        void node_changed(model::NodeIndex node, bool is_removed) override;

        ClientNodes& owner;
        ReferenceKey key;
    };
    struct Ends {
        Ends(ClientNodes& owner, const ReferenceKey& of) : source{owner, of}, target{owner, of} {}

        End source;
        End target;
    };

    std::unordered_map<model::NodeIndex, Node> nodes_;
    std::map<ReferenceKey, Ends> references_;
    std::size_t bytes_{0};
};

} // namespace busbar::server::detail

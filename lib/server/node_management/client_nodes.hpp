#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <tuple>
#include <unordered_map>

#include <busbar/model/address_space.hpp>
#include <busbar/server/limits.hpp>

namespace busbar::server::detail {

/// What clients have added to the address space, so that it stays within its limits.
class ClientNodes {
public:
    /// Forgets what is gone meanwhile, whoever removed it. To be called once a request.
    void refresh(const model::AddressSpace& space);

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
    void add(model::NodeHandle node, std::size_t bytes);

    [[nodiscard]] bool has_room_for_reference(const ServerLimits& limits) const
    {
        return references_.size() < limits.max_client_references;
    }
    void add_reference(const model::AddressSpace& space, model::NodeIndex source,
                       model::NodeIndex type, model::NodeIndex target)
    {
        references_.insert(key(space, source, type, target));
    }
    void remove_reference(const model::AddressSpace& space, model::NodeIndex source,
                          model::NodeIndex type, model::NodeIndex target)
    {
        references_.erase(key(space, source, type, target));
    }

private:
    struct Node {
        std::uint32_t generation{0};
        std::size_t bytes{0};
    };
    /// Source and target with their generations, and the type, which cannot be removed.
    using ReferenceKey = std::tuple<model::NodeIndex, std::uint32_t, model::NodeIndex,
                                    std::uint32_t, model::NodeIndex>;

    [[nodiscard]] static ReferenceKey key(const model::AddressSpace& space, model::NodeIndex source,
                                          model::NodeIndex type, model::NodeIndex target)
    {
        const model::NodeHandle from = space.handle(source);
        const model::NodeHandle to = space.handle(target);
        return {from.index, from.generation, to.index, to.generation, type};
    }

    std::unordered_map<model::NodeIndex, Node> nodes_;
    std::set<ReferenceKey> references_;
    std::size_t bytes_{0};
    std::uint64_t refreshed_at_{0};
};

} // namespace busbar::server::detail

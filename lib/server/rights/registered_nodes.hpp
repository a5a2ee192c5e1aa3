#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>

#include <busbar/core/api.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/model/space_reader.hpp>

namespace busbar::server::detail {

/// The aliases that RegisterNodes created for a session (Part 4, 5.9.5): numeric NodeIds of a place
/// with the node's handle, so that nothing is hashed or compared to find it.
///
/// The first number is random, and a place that is used again has another NodeId: a client that
/// uses an alias of another session, of the server before a restart, or one that was unregistered,
/// finds no node instead of a wrong one. Lives as long as the space.
class BUSBAR_API RegisteredNodes {
public:
    /// NamespaceIndices from here on belong to aliases; for spaces that have fewer namespaces.
    static constexpr std::uint16_t first_namespace = 0x8000;
    /// Bytes of a place.
    static constexpr std::size_t place_memory = 16;
    using Lot = std::array<std::byte, 6>;

    RegisteredNodes(const model::SpaceReader& space, const Lot& lot);

    [[nodiscard]] static bool is_alias(const NodeId& id)
    {
        return id.namespace_index() >= first_namespace && id.is_numeric();
    }
    /// Number of places to be created before `count` nodes can be added; 0 if enough are free.
    [[nodiscard]] std::size_t missing(std::size_t count) const;
    /// Creates `count` places.
    void make_places(std::size_t count);
    /// Returns a new alias of the node. There must be a free place.
    [[nodiscard]] NodeId add(model::NodeIndex node);
    /// Ids that are not aliases of this object are ignored (Part 4, 5.9.6.1).
    void remove(const NodeId& id);
    /// Returns the node of an alias, no_node if it is not an alias or the node was removed.
    [[nodiscard]] model::NodeIndex find(const NodeId& alias) const;
    /// Returns the NodeId of the node that `id` is an alias of; nothing if it is not an alias.
    /// Borrowed from the space.
    [[nodiscard]] std::optional<NodeId> canonical(const NodeId& id) const;
    /// Stores the node of each id, alias or not, in `found`, as SpaceReader::find_nodes.
    void find_nodes(std::span<const NodeId* const> ids, std::span<model::NodeIndex> found) const;

private:
    struct Place {
        /// While the place is free its index is the number of the next free one.
        model::NodeHandle node;
        /// Number of its previous uses.
        std::uint16_t uses{0};
        bool is_used{false};
    };
    static_assert(sizeof(Place) <= place_memory);

    static constexpr std::uint32_t none = UINT32_MAX;
    /// Maximum number of NodeIds of a place.
    static constexpr std::uint16_t most_uses = 0x10000 - first_namespace;

    /// Returns the place of an alias; null if it is not an alias.
    [[nodiscard]] const Place* place(const NodeId& id) const;

    const model::SpaceReader& space_;
    /// Identifier of the first place.
    std::uint32_t first_identifier_;
    std::uint16_t first_turn_;
    std::deque<Place> places_;
    std::uint32_t first_free_{none};
    std::size_t free_count_{0};
};

} // namespace busbar::server::detail

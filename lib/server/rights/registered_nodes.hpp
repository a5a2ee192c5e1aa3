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

/// The aliases that RegisterNodes gave a session (Part 4, 5.9.5): numeric NodeIds that name a place
/// which has the handle of the node, so that nothing is hashed or compared to find it.
///
/// Where they begin is drawn by lot, and a place that is used again has another NodeId: who takes
/// an alias of another session, of the server before a restart, or one that was given back, finds
/// no node rather than a wrong one. As long as the space.
class BUSBAR_API RegisteredNodes {
public:
    /// NamespaceIndices from here on are of aliases; for spaces that have fewer namespaces.
    static constexpr std::uint16_t first_namespace = 0x8000;
    /// Bytes of a place.
    static constexpr std::size_t place_memory = 16;
    using Lot = std::array<std::byte, 6>;

    RegisteredNodes(const model::SpaceReader& space, const Lot& lot);

    [[nodiscard]] static bool is_alias(const NodeId& id)
    {
        return id.namespace_index() >= first_namespace && id.is_numeric();
    }
    /// So many places are to be made before `count` nodes can be added; 0 if that many are free.
    [[nodiscard]] std::size_t missing(std::size_t count) const;
    /// Makes so many.
    void make_places(std::size_t count);
    /// An alias of the node. There must be a free place.
    [[nodiscard]] NodeId add(model::NodeIndex node);
    /// Ids that are no aliases of these are ignored (Part 4, 5.9.6.1).
    void remove(const NodeId& id);
    /// The node of an alias, no_node if it is none of these or the node was removed.
    [[nodiscard]] model::NodeIndex find(const NodeId& alias) const;
    /// The NodeId of the node that `id` is an alias of; nothing if it is none. Borrowed from the
    /// space.
    [[nodiscard]] std::optional<NodeId> canonical(const NodeId& id) const;
    /// Puts the node of each into `found`, aliases or not, as SpaceReader::find_nodes.
    void find_nodes(std::span<const NodeId* const> ids, std::span<model::NodeIndex> found) const;

private:
    struct Place {
        /// While it is free its index is the number of the next free one.
        model::NodeHandle node;
        /// How often it was used before.
        std::uint16_t uses{0};
        bool is_used{false};
    };
    static_assert(sizeof(Place) <= place_memory);

    static constexpr std::uint32_t none = UINT32_MAX;
    /// So often a place has another NodeId.
    static constexpr std::uint16_t most_uses = 0x10000 - first_namespace;

    /// The place of an alias; null if it is none of these.
    [[nodiscard]] const Place* place(const NodeId& id) const;

    const model::SpaceReader& space_;
    /// Of the first place.
    std::uint32_t first_identifier_;
    std::uint16_t first_turn_;
    std::deque<Place> places_;
    std::uint32_t first_free_{none};
    std::size_t free_count_{0};
};

} // namespace busbar::server::detail

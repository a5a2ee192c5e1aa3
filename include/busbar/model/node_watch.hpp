#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/api.hpp>
#include <busbar/model/node.hpp>

namespace busbar::model {

namespace detail {
class WatchTable;
} // namespace detail

/// What is watched of a node. Its removal is told in any case.
enum class NodeAspect : std::uint8_t {
    /// Nothing but its removal.
    Existence,
    /// What answers for it and who may use it: data source and handle, access levels, NodeAccess,
    /// the AccessRestrictions of its namespace.
    Binding,
    /// Which references it has, forward and inverse, as far as they are kept.
    References,
    /// Where its references lie: positions of a ReferenceCursor lead elsewhere afterwards. This is
    /// rare: what is added comes last, and what is removed leaves its place free for a while.
    ReferencePositions,
};

/// Waits for one change of one node: derive from it to be told. While it watches it takes memory in
/// the AddressSpace (node_watch_memory); if a peer can cause watches, charge the peer for them.
///
/// SpaceJournal::watch starts it. It ends once it has told of a change, when it is stopped,
/// destroyed or started again, and when the AddressSpace is destroyed or assigned to, of which it
/// does not tell. If the AddressSpace is moved, the watch goes with its nodes. To be used only by
/// the thread that changes the AddressSpace.
class BUSBAR_API NodeWatch {
public:
    NodeWatch() = default;
    NodeWatch(const NodeWatch&) = delete;
    NodeWatch& operator=(const NodeWatch&) = delete;
    virtual ~NodeWatch() { stop(); }

    [[nodiscard]] bool is_watching() const { return table_ != nullptr; }
    void stop();

private:
    friend class detail::WatchTable;

    /// Called in the middle of a change. It must not change the AddressSpace, whose answers may be
    /// half old and half new: take a note and look later. It may destroy, stop or start any watch,
    /// this one included, but must not watch `node` again if `is_removed`: its index is free for
    /// another node.
    virtual void node_changed(NodeIndex node, bool is_removed) = 0;

    detail::WatchTable* table_{nullptr};
    /// What leads to this one: the pointer in the table or in the watch before.
    NodeWatch** link_{nullptr};
    NodeWatch* next_{nullptr};
    NodeIndex node_{no_node};
    NodeAspect aspect_{NodeAspect::Existence};
};

/// How many bytes a watch takes in the AddressSpace besides its own object; an upper estimate.
inline constexpr std::size_t node_watch_memory = 64;

} // namespace busbar::model

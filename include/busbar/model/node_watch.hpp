#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/api.hpp>
#include <busbar/model/node.hpp>

namespace busbar::model {

namespace detail {
class WatchTable;
} // namespace detail

/// The aspect of a node that is watched. Its removal is reported in any case.
enum class NodeAspect : std::uint8_t {
    /// Only its removal.
    Existence,
    /// Its data source and handle, and access to it: access levels, NodeAccess, the
    /// AccessRestrictions of its namespace.
    Binding,
    /// Its references, forward and inverse, as far as they are kept.
    References,
    /// The positions of its references: those of a ReferenceCursor are invalid afterwards. This is
    /// rare: a new reference comes last, and a removed one leaves its place free for a while.
    ReferencePositions,
};

/// Waits for one change of one node: derive from it to be notified. While it watches it takes
/// memory in the AddressSpace (node_watch_memory); if a peer can cause watches, charge the peer for
/// them.
///
/// SpaceJournal::watch starts it. It ends once it has reported a change, when it is stopped,
/// destroyed or started again, and when the AddressSpace is destroyed or assigned to, which it does
/// not report. If the AddressSpace is moved, the watch goes with its nodes. To be used only by the
/// thread that changes the AddressSpace.
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
    /// The pointer to this watch, in the table or in the watch before.
    NodeWatch** link_{nullptr};
    NodeWatch* next_{nullptr};
    NodeIndex node_{no_node};
    NodeAspect aspect_{NodeAspect::Existence};
};

/// Upper estimate of the memory that a watch takes in the AddressSpace in addition to its own
/// object, in bytes.
inline constexpr std::size_t node_watch_memory = 64;

} // namespace busbar::model

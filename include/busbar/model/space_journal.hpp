#pragma once

#include <cstdint>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/model/node.hpp>
#include <busbar/model/node_watch.hpp>

namespace busbar::model {

class SpaceReader;

/// A change of a node that has a NodeVersion (Part 5, 12.16).
struct ModelChange {
    NodeId affected;
    /// The TypeDefinition of an Object or Variable, else null.
    NodeId affected_type;
    /// Bits of ModelChangeStructureVerbMask.
    std::uint8_t verb{0};
};

/// The changes since they were last taken.
struct ModelChanges {
    /// One for each node, in the order of their first changes. They own their strings.
    std::vector<ModelChange> changes;
    /// False if there were more than the limit.
    bool is_complete{true};
};

/// Tells what has changed in an AddressSpace: for clients, which are told of nodes that have the
/// Property NodeVersion and of no others (Part 3, 9.32.2), and for code that keeps something found
/// at a node.
///
/// A view of one AddressSpace, cheap to create and to copy, and valid until that is moved or
/// destroyed. To be used only by the thread that changes the AddressSpace.
class BUSBAR_API SpaceJournal {
public:
    explicit SpaceJournal(const SpaceReader& space) : space_{&space} {}

    /// True if take_changes has something to return.
    [[nodiscard]] bool has_changes() const;
    /// Returns the changes since the last call of nodes that have a NodeVersion. At most 1,000
    /// nodes are kept; later ones are lost, and `is_complete` is false then.
    [[nodiscard]] ModelChanges take_changes();
    /// Returns the Property NodeVersion that was added to the node; no_node if there is none.
    [[nodiscard]] NodeIndex node_version(NodeIndex node) const;
    /// Calls `visit` with each of these Properties, in no particular order.
    void for_each_node_version(FunctionRef<void(NodeIndex)> visit) const;
    /// Counts removals of nodes with a data source and rebindings of any node: code that keeps
    /// handles of many nodes for a moment can tell that none of them has changed.
    [[nodiscard]] std::uint64_t rebindings() const;
    /// A number that changes whenever RolePermissions or AccessRestrictions are set.
    [[nodiscard]] std::uint64_t access_changes() const;
    /// Notifies `watch` of the next change of this aspect of the node, or of the node's removal.
    /// Ends what `watch` waited for before.
    void watch(NodeIndex node, NodeAspect aspect, NodeWatch& watch) const;

private:
    const SpaceReader* space_;
};

} // namespace busbar::model

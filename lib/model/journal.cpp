#include "journal.hpp"

#include <utility>

#include <busbar/types/enumerations.hpp>

#include "tables.hpp"

namespace busbar::model {

namespace detail {

NodeIndex Journal::property_of(NodeIndex node) const
{
    const auto found = versioned_.find(node);
    return found == versioned_.end() ? no_node : found->second.property;
}

ModelChanges Journal::take()
{
    ++round_;
    return std::exchange(pending_, {});
}

void Tables::note(NodeIndex node, unsigned verb)
{
    journal.note(node, verb, [&](ModelChange& change) {
        if (is_constant(node)) {
            change.affected = id_of(node);
            return;
        }
        const Record& from = record(node);
        // Copies own their text.
        const NodeId id = from.node_id();
        change.affected = id;
        if (from.type_definition != no_node) {
            const NodeId type = id_of(from.type_definition);
            change.affected_type = type;
        }
        if (from.generation > journal.taken_generation) {
            change.verb = static_cast<std::uint8_t>(ModelChangeStructureVerbMask::NodeAdded);
        }
    });
}

NodeId Tables::id_of(NodeIndex node) const
{
    return is_constant(node) ? NodeId{0, constant(node).id.value} : record(node).node_id();
}

bool Tables::is_node_version(const Record& child) const
{
    return child.browse_namespace == 0 && child.parent_reference == has_property &&
           child.name() == "NodeVersion";
}

} // namespace detail

bool AddressSpace::has_changes() const
{
    return !tables_->journal.is_empty();
}

ModelChanges AddressSpace::take_changes()
{
    tables_->journal.taken_generation = tables_->next_generation;
    ModelChanges taken = tables_->journal.take();
    for (ModelChange& change : taken.changes) {
        const NodeIndex node = find(change.affected);
        if (node != no_node && tables_->is_constant(node)) {
            const NodeIndex type = type_definition(node);
            change.affected_type = type == no_node ? NodeId{} : node_id(type);
        }
    }
    return taken;
}

NodeIndex AddressSpace::node_version(NodeIndex node) const
{
    return tables_->journal.property_of(node);
}

void AddressSpace::for_each_node_version(FunctionRef<void(NodeIndex)> visit) const
{
    tables_->journal.for_each_property(visit);
}

NodeId AddressSpace::free_id(std::uint16_t namespace_index)
{
    return tables_->free_id(namespace_index);
}

} // namespace busbar::model

#include "journal.hpp"

#include <utility>

#include <busbar/model/space_reader.hpp>
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
        const NodeRecord& from = record(node);
        // Copies own their text.
        const NodeId id = from.node_id();
        change.affected = id;
        if (const NodeIndex definition = links(node).type_definition; definition != no_node) {
            const NodeId type = id_of(definition);
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

bool Tables::is_node_version(NodeIndex child) const
{
    const NodeRecord& from = record(child);
    return from.browse_namespace == 0 && links(child).parent_reference == has_property &&
           from.name(links(child)) == "NodeVersion";
}

} // namespace detail

bool SpaceJournal::has_changes() const
{
    return !space_->tables_->journal.is_empty();
}

std::uint64_t SpaceJournal::rebindings() const
{
    return space_->tables_->rebindings;
}

std::uint64_t SpaceJournal::access_changes() const
{
    return space_->tables_->access_changes;
}

ModelChanges SpaceJournal::take_changes()
{
    space_->tables_->journal.taken_generation = space_->tables_->next_generation;
    ModelChanges taken = space_->tables_->journal.take();
    for (ModelChange& change : taken.changes) {
        const NodeIndex node = space_->find(change.affected);
        if (node != no_node && space_->tables_->is_constant(node)) {
            const NodeIndex type = space_->type_definition(node);
            change.affected_type = type == no_node ? NodeId{} : space_->node_id(type);
        }
    }
    return taken;
}

NodeIndex SpaceJournal::node_version(NodeIndex node) const
{
    return space_->tables_->journal.property_of(node);
}

void SpaceJournal::for_each_node_version(FunctionRef<void(NodeIndex)> visit) const
{
    space_->tables_->journal.for_each_property(visit);
}

} // namespace busbar::model

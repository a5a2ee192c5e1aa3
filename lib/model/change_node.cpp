#include <span>

#include <busbar/model/address_space.hpp>

#include "record.hpp"
#include "tables.hpp"

namespace busbar::model {

using detail::Entry;
using detail::NodeRecord;
using detail::Overlay;
using detail::ReferenceList;
using detail::Tables;

namespace {

bool has_children(const Tables& tables, NodeIndex node)
{
    const ReferenceList* const list = tables.list(node);
    return list != nullptr && list->entries.size() - list->holes > list->others;
}

/// Returns the node and everything that was added below it, parents before children.
std::vector<NodeIndex> subtree(const Tables& tables, NodeIndex root)
{
    std::vector<NodeIndex> nodes{root};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const ReferenceList* const list = tables.list(nodes[i]);
        for (std::uint32_t slot = 0; list != nullptr && slot < list->entries.size(); ++slot) {
            const Entry& entry = list->entries[slot];
            if (!entry.is_hole() && entry.is_forward() && !tables.is_constant(entry.target) &&
                tables.links(entry.target).parent == nodes[i] &&
                tables.links(entry.target).parent_slot == slot) {
                nodes.push_back(entry.target);
            }
        }
    }
    return nodes;
}

/// Removes the references that add_reference added from the nodes at their other ends.
void remove_from_others(Tables& tables, NodeIndex node)
{
    const ReferenceList* const list = tables.list(node);
    for (std::size_t i = 0; list != nullptr && i < list->entries.size(); ++i) {
        const Entry entry = list->entries[i];
        if (!entry.is_hole() && entry.target != node) {
            static_cast<void>(
                tables.remove_entry(entry.target, Entry{entry.type(), node, !entry.is_forward()}));
        }
    }
}

/// Parents precede children.
void remove_all(Tables& tables, std::span<const NodeIndex> nodes)
{
    for (const NodeIndex each : nodes) { // while the NodeVersion still exists
        tables.note(each, static_cast<unsigned>(ModelChangeStructureVerbMask::NodeDeleted));
    }
    for (auto at = nodes.rbegin(); at != nodes.rend(); ++at) {
        remove_from_others(tables, *at);
        tables.unlink(*at);
        tables.destroy(*at);
    }
}

} // namespace

void SpaceReader::for_each_below(NodeIndex node, FunctionRef<bool(NodeIndex)> visit) const
{
    for (const NodeIndex each : subtree(*tables_, node)) {
        if (!visit(each)) {
            return;
        }
    }
}

Result<void> AddressSpace::remove(NodeIndex node)
{
    if (!exists(node)) {
        return fail(status::Bad_NodeIdUnknown);
    }
    if (tables_->is_constant(node) || detail::is_type(node_class(node))) {
        return fail(status::Bad_NoDeleteRights);
    }
    if (!has_children(*tables_, node)) { // which needs no memory
        remove_all(*tables_, std::span{&node, 1});
        return {};
    }
    // From here on nothing can fail.
    const std::vector<NodeIndex> nodes = subtree(*tables_, node);
    remove_all(*tables_, nodes);
    return {};
}

Result<void> AddressSpace::set_value(NodeIndex node, Variant value)
{
    return set_data_value(node, DataValue{std::move(value)});
}

Result<void> AddressSpace::set_data_value(NodeIndex node, DataValue value)
{
    const VariableAttributes attributes = variable(node);
    if (attributes.data_type != no_node) {
        const StatusCode fits = check_value(value.value, attributes.data_type,
                                            attributes.value_rank, attributes.array_dimensions);
        if (!fits.is_good()) {
            return fail(fits);
        }
    }
    tables_->translations.erase(node, AttributeId::Value);
    const bool is_timed = !value.source_timestamp.is_null();
    const detail::ValueQuality quality{is_timed ? value.source_timestamp : detail::no_time,
                                       value.status, value.source_picoseconds};
    if (tables_->is_constant(node)) {
        Overlay& overlay = tables_->make_overlay(node);
        overlay.value = std::move(value.value);
        overlay.quality = quality;
        overlay.has_value = true;
    } else {
        detail::Extra& extra = tables_->record(node).make_extra();
        extra.value = std::move(value.value);
        extra.quality = quality;
    }
    return {};
}

void AddressSpace::bind(NodeIndex node, std::uint32_t source, std::uint64_t handle)
{
    ++tables_->rebindings;
    if (tables_->is_constant(node)) {
        Overlay& overlay = tables_->make_overlay(node);
        overlay.source = source;
        overlay.handle = handle;
    } else {
        NodeRecord& record = tables_->record(node);
        record.source = source;
        record.handle = handle;
    }
    tables_->watches.tell(node, NodeAspect::Binding);
}

void AddressSpace::set_access_level(NodeIndex node, Access access_level, Access user_access_level)
{
    const auto level = static_cast<std::uint8_t>(access_level);
    const auto of_user = static_cast<std::uint8_t>(access_level & user_access_level);
    if (tables_->is_constant(node)) {
        Overlay& overlay = tables_->make_overlay(node);
        overlay.access_level = level;
        overlay.user_access_level = of_user;
        overlay.has_access_level = true;
    } else {
        NodeRecord& record = tables_->record(node);
        record.access_level = level;
        record.user_access_level = of_user;
    }
    tables_->watches.tell(node, NodeAspect::Binding);
}

void AddressSpace::set_executable(NodeIndex node, bool executable)
{
    if (tables_->is_constant(node)) {
        Overlay& overlay = tables_->make_overlay(node);
        overlay.executable = executable;
        overlay.has_executable = true;
    } else {
        std::uint8_t& flags = tables_->record(node).flags;
        flags = static_cast<std::uint8_t>(executable ? flags | static_flag::executable
                                                     : flags & ~static_flag::executable);
    }
}

void AddressSpace::set_minimum_sampling_interval(NodeIndex node, double interval)
{
    tables_->record(node).minimum_sampling_interval = interval;
}

} // namespace busbar::model

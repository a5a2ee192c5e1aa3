#include <busbar/core/detail/guarded.hpp>
#include <busbar/model/address_space.hpp>

#include "tables.hpp"

namespace busbar::model {

using detail::Entry;
using detail::NodeLinks;
using detail::number;
using detail::ReferenceList;
using detail::Tables;

namespace {

/// Searches the end that has fewer references, since a folder may have very many. Both ends have
/// them except for HasModellingRule, whose inverse is not kept.
bool has_reference(const SpaceReader& space, NodeIndex source, NodeIndex type, NodeIndex target)
{
    const ReferenceCursor forward = space.references(source);
    const ReferenceCursor inverse = space.references(target);
    const bool has_inverse = type != space.find(detail::id_has_modelling_rule);
    const bool is_inverse = has_inverse && inverse.at_most() < forward.at_most();
    const NodeIndex other = is_inverse ? source : target;
    ReferenceCursor cursor = is_inverse ? inverse : forward;
    while (const auto reference = cursor.next()) {
        if (reference->type == type && reference->target == other &&
            reference->is_forward != is_inverse) {
            return true;
        }
    }
    return false;
}

} // namespace

std::optional<Reference> ReferenceCursor::next()
{
    while (position_ < end_) {
        std::size_t at = position_++;
        if (at < constant_count_) {
            const StaticReference& reference = constant_[at];
            const std::uint32_t type = static_nodes_->reference_types[reference.type()];
            if (type < static_nodes_->nodes.size() &&
                reference.target() < static_nodes_->nodes.size()) {
                return Reference{NodeIndex{type}, NodeIndex{reference.target()},
                                 reference.is_forward()};
            }
            continue;
        }
        at -= constant_count_;
        if (at < own_count_) {
            return own_[at];
        }
        const Entry& entry = entries_[at - own_count_];
        if (!entry.is_hole()) {
            return Reference{entry.type(), entry.target, entry.is_forward()};
        }
    }
    return std::nullopt;
}

ReferenceCursor SpaceReader::references(NodeIndex node, std::size_t position) const
{
    ReferenceCursor cursor;
    const Tables& tables = *tables_;
    if (tables.is_constant(node)) {
        const auto all = tables.constants->references;
        const std::size_t first = tables.constant(node).first_reference;
        const std::size_t next = number(node) + std::size_t{1};
        const std::size_t last = next < tables.constant_count
                                     ? tables.constants->nodes[next].first_reference
                                     : all.size();
        cursor.static_nodes_ = tables.constants;
        cursor.constant_ = all.data() + first;
        cursor.constant_count_ = last - first;
    } else {
        const NodeLinks& links = tables.links(node);
        if (links.parent != no_node) {
            cursor.own_[cursor.own_count_++] = {links.parent_reference, links.parent, false};
        }
        if (links.type_definition != no_node) {
            cursor.own_[cursor.own_count_++] = {tables.has_type_definition, links.type_definition,
                                                true};
        }
    }
    cursor.end_ = cursor.constant_count_ + cursor.own_count_;
    if (const ReferenceList* const list = tables.list(node)) {
        cursor.entries_ = list->entries.data();
        cursor.end_ += list->entries.size();
    }
    cursor.position_ = position < cursor.end_ ? position : cursor.end_;
    return cursor;
}

std::uint32_t SpaceReader::addition_count() const
{
    return tables_->next_generation;
}

std::uint64_t SpaceReader::type_count() const
{
    return tables_->type_count;
}

NodeIndex SpaceReader::type_definition(NodeIndex node) const
{
    if (!tables_->is_constant(node)) {
        return tables_->links(node).type_definition;
    }
    ReferenceCursor cursor = references(node);
    while (const auto reference = cursor.next()) {
        if (reference->is_forward && reference->type == tables_->has_type_definition) {
            return reference->target;
        }
    }
    return no_node;
}

NodeIndex SpaceReader::next_instance(NodeIndex type, NodeIndex& from, std::size_t& visits) const
{
    const std::uint32_t end = tables_->constant_count + tables_->record_count;
    for (std::uint32_t at = detail::number(from); at < end; ++at) {
        if (visits == 0) {
            from = NodeIndex{at};
            return no_node;
        }
        --visits;
        if (type_definition(NodeIndex{at}) == type) { // a free record has no type definition
            from = NodeIndex{at + 1};
            return NodeIndex{at};
        }
    }
    from = no_node;
    return no_node;
}

std::size_t SpaceReader::for_each_child(NodeIndex parent, NodeIndex type, bool include_subtypes,
                                        const QualifiedName& name,
                                        FunctionRef<bool(NodeIndex)> visit) const
{
    const Tables& tables = *tables_;
    const auto fits = [&](NodeIndex reference) {
        return include_subtypes ? is_subtype_of(reference, type) : reference == type;
    };
    bool goes_on = true;
    // Children that were added below `parent` are found by name, however many there are.
    static_cast<void>(tables.find_child(parent, name, [&](NodeIndex child) {
        if (fits(tables.links(child).parent_reference)) {
            goes_on = visit(child);
        }
        return !goes_on;
    }));
    const ReferenceList* const list = tables.list(parent);
    const bool has_others = list != nullptr && list->others != 0;
    ReferenceCursor cursor = references(parent);
    if (!has_others && list != nullptr) {
        cursor.end_ -= list->entries.size();
    }
    while (goes_on) {
        const auto reference = cursor.next();
        if (!reference) {
            break;
        }
        if (!reference->is_forward || !fits(reference->type)) {
            continue;
        }
        const bool was_found = !tables.is_constant(reference->target) &&
                               tables.links(reference->target).parent == parent &&
                               tables.links(reference->target).parent_reference == reference->type;
        if (!was_found && browse_name(reference->target) == name) {
            goes_on = visit(reference->target);
        }
    }
    return cursor.position();
}

Result<void> AddressSpace::add_reference(NodeIndex source, const NodeId& type, NodeIndex target)
{
    if (!exists(source) || !exists(target)) {
        return fail(exists(source) ? status::Bad_TargetNodeIdInvalid
                                   : status::Bad_SourceNodeIdInvalid);
    }
    const NodeIndex reference_type = find(type);
    if (reference_type == no_node || node_class(reference_type) != NodeClass::ReferenceType ||
        is_abstract(reference_type)) {
        return fail(status::Bad_ReferenceTypeIdInvalid);
    }
    // Each node has one of both from its creation (Part 3, 7.10 and 7.13).
    if (is_subtype_of(reference_type, detail::id_has_subtype) ||
        is_subtype_of(reference_type, detail::id_has_type_definition)) {
        return fail(status::Bad_ReferenceNotAllowed);
    }
    // A node never references itself hierarchically (Part 3, 7.3).
    if (source == target && is_subtype_of(reference_type, detail::id_hierarchical_references)) {
        return fail(status::Bad_ReferenceNotAllowed);
    }
    if (has_reference(*this, source, reference_type, target)) {
        return fail(status::Bad_DuplicateReferenceNotAllowed);
    }
    tables_->add_entry(source, Entry{reference_type, target, true});
    busbar::detail::Undo undo{[&] {
        static_cast<void>(tables_->remove_entry(source, Entry{reference_type, target, true}));
    }};
    tables_->add_entry(target, Entry{reference_type, source, false});
    undo.keep();
    return {};
}

Result<void> AddressSpace::remove_reference(NodeIndex source, const NodeId& type, NodeIndex target)
{
    const NodeIndex reference_type = find(type);
    if (!exists(source) || !exists(target) || reference_type == no_node ||
        !tables_->remove_entry(source, Entry{reference_type, target, true})) {
        return fail(status::Bad_NotFound);
    }
    static_cast<void>(tables_->remove_entry(target, Entry{reference_type, source, false}));
    return {};
}

} // namespace busbar::model

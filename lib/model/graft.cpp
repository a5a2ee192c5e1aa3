#include "graft.hpp"

#include <algorithm>
#include <tuple>

namespace busbar::model::detail {

Graft::Graft(AddressSpace& space)
    : space_{space}, tables_{*space.tables_}, namespace_count_{tables_.namespaces.size()}
{
}

Graft::~Graft()
{
    if (!is_kept_) {
        take_back();
    }
}

void Graft::reserve(std::size_t node_count)
{
    space_.reserve(node_count);
    created_.reserve(node_count);
}

Result<std::uint16_t> Graft::add_namespace(std::string_view uri)
{
    return space_.add_namespace(uri);
}

Result<NodeIndex> Graft::create(const NodeId& id, const QualifiedName& name, NodeClass node_class)
{
    if (tables_.find(id) != no_node) {
        return fail(status::Bad_NodeIdExists);
    }
    if (tables_.record_count + std::size_t{1} >= IndexTable::max_records) {
        return fail(status::Bad_OutOfMemory);
    }
    const NodeIndex node = tables_.create(id, name, node_class);
    positions_.resize(tables_.record_count);
    created_.push_back(node);
    positions_[number(node) - tables_.constant_count] = static_cast<std::uint32_t>(created_.size());
    return node;
}

std::uint32_t Graft::position(NodeIndex node) const
{
    const std::uint32_t record = number(node) - tables_.constant_count;
    return tables_.is_constant(node) || record >= positions_.size() ? none : positions_[record] - 1;
}

void Graft::add_reference(NodeIndex source, NodeIndex type, NodeIndex target)
{
    if (position(source) != none || position(target) != none) {
        links_.push_back({source, type, target, static_cast<std::uint32_t>(links_.size())});
    }
}

void Graft::link()
{
    supertypes_.assign(created_.size(), no_node);
    above_.assign(created_.size(), none);
    remove_duplicates();
    find_supertypes();
    place_types();
    choose_parents();
    add_others();
}

void Graft::remove_duplicates()
{
    const auto key = [](const Link& link) {
        return std::tuple{link.source, link.type, link.target};
    };
    std::sort(links_.begin(), links_.end(), [&](const Link& a, const Link& b) {
        return std::tuple{key(a), a.order} < std::tuple{key(b), b.order};
    });
    const auto end = std::unique(links_.begin(), links_.end(),
                                 [&](const Link& a, const Link& b) { return key(a) == key(b); });
    links_.erase(end, links_.end());
    std::sort(links_.begin(), links_.end(),
              [](const Link& a, const Link& b) { return a.order < b.order; });
}

void Graft::find_supertypes()
{
    for (Link& link : links_) {
        const std::uint32_t at = position(link.target);
        if (link.type == tables_.has_subtype && at != none && link.source != link.target &&
            is_type(record(link.target).node_class()) && supertypes_[at] == no_node) {
            supertypes_[at] = link.source;
            link.is_used = true;
        }
    }
}

/// A type is placed after its supertype, whose chain it continues.
void Graft::place_types()
{
    enum class State : std::uint8_t { New, Open, Placed };
    std::vector<State> states(created_.size(), State::New);
    std::vector<std::uint32_t> way;
    for (std::uint32_t i = 0; i < created_.size(); ++i) {
        std::uint32_t at = is_type(record(created_[i]).node_class()) ? i : none;
        while (at != none && states[at] == State::New) {
            states[at] = State::Open;
            way.push_back(at);
            at = supertypes_[at] == no_node ? none : position(supertypes_[at]);
        }
        const bool is_circle = at != none && states[at] == State::Open;
        if (is_circle) {
            supertypes_[way.back()] = no_node;
        }
        for (; !way.empty(); way.pop_back()) {
            place_type_below(created_[way.back()], supertypes_[way.back()]);
            states[way.back()] = State::Placed;
        }
    }
}

void Graft::place_type_below(NodeIndex type, NodeIndex supertype)
{
    if (supertype != no_node) {
        attach(supertype, tables_.has_subtype, type);
    }
    tables_.place_type(type, supertype);
}

void Graft::choose_parents()
{
    for (Link& link : links_) {
        const std::uint32_t at = position(link.target);
        if (at == none || is_type(record(link.target).node_class()) ||
            tables_.links(link.target).parent != no_node ||
            !space_.is_subtype_of(link.type, id_hierarchical_references)) {
            continue;
        }
        const std::uint32_t from = position(link.source);
        if (from == none || root(from) != at) {
            attach(link.source, link.type, link.target);
            above_[at] = from;
            link.is_used = true;
        }
    }
}

/// Returns the topmost created node above.
std::uint32_t Graft::root(std::uint32_t at)
{
    while (above_[at] != none) {
        if (above_[above_[at]] != none) {
            above_[at] = above_[above_[at]];
        }
        at = above_[at];
    }
    return at;
}

void Graft::attach(NodeIndex parent, NodeIndex type, NodeIndex child)
{
    tables_.link(parent, type, child);
    if (position(parent) == none) {
        touched_.push_back(parent);
    }
}

void Graft::add_entry(NodeIndex node, const Entry& entry)
{
    tables_.add_entry(node, entry);
    if (position(node) == none) {
        touched_.push_back(node);
    }
}

/// Adds the references that are not in the records themselves. Inverse HasTypeDefinition is not
/// kept, nor is inverse HasModellingRule of a constant rule: a removable node must know the nodes
/// that refer to it.
void Graft::add_others()
{
    const NodeIndex has_modelling_rule = tables_.find_constant(id_has_modelling_rule);
    for (const Link& link : links_) {
        if (link.type == tables_.has_type_definition) {
            if (position(link.source) != none &&
                tables_.links(link.source).type_definition == no_node) {
                tables_.links(link.source).type_definition = link.target;
            }
            continue;
        }
        if (link.is_used) {
            continue;
        }
        add_entry(link.source, Entry{link.type, link.target, true});
        if (link.type != has_modelling_rule || !tables_.is_constant(link.target)) {
            add_entry(link.target, Entry{link.type, link.source, false});
        }
    }
}

/// Turns the references to created nodes into holes.
void Graft::forget_created(NodeIndex node)
{
    ReferenceList& list = tables_.make_list(node);
    list.index.reset();
    for (Entry& entry : list.entries) {
        if (!entry.is_hole() && position(entry.target) != none) {
            entry = {};
            ++list.holes;
            --list.others;
        }
    }
    tables_.watches.tell(node, NodeAspect::References);
}

void Graft::take_back()
{
    for (const NodeIndex node : created_) {
        tables_.unlink(node);
    }
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
    for (const NodeIndex node : touched_) {
        forget_created(node);
    }
    for (auto node = created_.rbegin(); node != created_.rend(); ++node) {
        tables_.destroy(*node);
    }
    tables_.namespaces.shrink(namespace_count_);
}

} // namespace busbar::model::detail

#include <algorithm>

#include <busbar/core/detail/basic_ids.hpp>

#include "load_plan.hpp"
#include "node_flags.hpp"

namespace busbar::nodeset {

namespace {

constexpr std::uint32_t hierarchical_references = busbar::detail::basic_id::HierarchicalReferences;
constexpr std::uint32_t has_child = busbar::detail::basic_id::HasChild;

} // namespace

const Node* LoadPlan::type_above(const Node& node) const
{
    return find(supertypes_[position(node)]).node;
}

/// Valid once check_type_levels has found that the type hierarchy has no circles.
bool LoadPlan::is_below(const NodeId& reference_type, std::uint32_t base)
{
    auto& known = base == hierarchical_references ? is_hierarchical_ : is_has_child_;
    if (const auto found = known.find(reference_type); found != known.end()) {
        return found->second;
    }
    Target at = find(reference_type);
    while (at.node != nullptr) {
        at = find(supertypes_[position(*at.node)]);
    }
    const bool result = space_.is_subtype_of(at.index, base);
    known.emplace(reference_type, result);
    return result;
}

/// Checks that no type is above itself, and none too far below.
void LoadPlan::check_type_levels()
{
    const std::size_t most = document_.limits().max_type_levels;
    std::vector<std::size_t> levels(document_.nodes().size(), 0);
    for (const Node& node : document_.nodes()) {
        if (!is_type(node) || is_skipped(node)) {
            continue;
        }
        std::vector<const Node*> way;
        const Node* at = &node;
        while (at != nullptr && levels[position(*at)] == 0 && way.size() <= most) {
            way.push_back(at);
            at = type_above(*at);
        }
        std::size_t level = at == nullptr ? 0 : levels[position(*at)];
        for (; !way.empty(); way.pop_back()) {
            levels[position(*way.back())] = ++level;
        }
        if (level > most) {
            fail(node, "found HasSubtype references in a circle or more than " +
                           std::to_string(most) + " levels deep");
            return;
        }
    }
}

/// Checks that HasChild references never lead back to a node (Part 3, 7.5).
void LoadPlan::check_circles()
{
    const auto& nodes = document_.nodes();
    std::vector<std::vector<std::uint32_t>> children(nodes.size());
    std::vector<std::uint32_t> parent_counts(nodes.size(), 0);
    collect_children(children, parent_counts);
    std::vector<std::uint32_t> free;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (parent_counts[i] == 0) {
            free.push_back(i);
        }
    }
    std::size_t count = 0;
    for (; !free.empty(); ++count) {
        const std::uint32_t at = free.back();
        free.pop_back();
        for (const std::uint32_t child : children[at]) {
            if (--parent_counts[child] == 0) {
                free.push_back(child);
            }
        }
    }
    if (count != nodes.size()) {
        const auto first = std::find_if(parent_counts.begin(), parent_counts.end(),
                                        [](std::uint32_t parents) { return parents != 0; });
        fail(nodes[static_cast<std::size_t>(first - parent_counts.begin())],
             "found HasChild references that lead back to the node or to one above it");
    }
}

void LoadPlan::collect_children(std::vector<std::vector<std::uint32_t>>& children,
                                std::vector<std::uint32_t>& parent_counts)
{
    for (const Node& node : document_.nodes()) {
        if (is_skipped(node)) {
            continue;
        }
        for (const Reference& reference : node.references) {
            const Node* const other = find(reference.target).node;
            if (other == nullptr || !is_below(reference.type, has_child)) {
                continue;
            }
            const Node& parent = reference.is_forward ? node : *other;
            const Node& child = reference.is_forward ? *other : node;
            children[position(parent)].push_back(static_cast<std::uint32_t>(position(child)));
            ++parent_counts[position(child)];
        }
    }
}

} // namespace busbar::nodeset

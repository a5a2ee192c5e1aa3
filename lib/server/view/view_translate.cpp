#include <algorithm>
#include <vector>

#include <busbar/types/ids.hpp>

#include "view_context.hpp"

namespace busbar::server::detail {

namespace {

using model::NodeIndex;

/// Nodes at one level of a path.
using Level = std::vector<NodeIndex>;

StatusCode check_path(const ViewContext& context, const RelativePath& path)
{
    if (path.elements.empty()) {
        return status::Bad_NothingToDo;
    }
    if (path.elements.size() > context.limits.max_browse_path_elements) {
        return status::Bad_QueryTooComplex;
    }
    for (const RelativePathElement& element : path.elements) {
        if (element.target_name.name.empty()) {
            return status::Bad_BrowseNameInvalid;
        }
    }
    return status::Good;
}

/// One step along `element` from all nodes of a level.
class Step {
public:
    Step(ViewContext& context, const RelativePathElement& element)
        : context_{context}, element_{element}, type_{element.reference_type_id.is_null()
                                                          ? model::no_node
                                                          : context.space.find(
                                                                element.reference_type_id)}
    {
    }

    [[nodiscard]] StatusCode check() const
    {
        const bool is_valid = element_.reference_type_id.is_null() ||
                              (type_ != model::no_node &&
                               context_.space.node_class(type_) == NodeClass::ReferenceType);
        return is_valid ? status::Good : status::Bad_ReferenceTypeIdInvalid;
    }
    /// Good, or Bad_TooManyMatches past `most` targets, Bad_QueryTooComplex past the work that one
    /// request may cause.
    [[nodiscard]] StatusCode take(const Level& from, Level& to, std::size_t most)
    {
        for (const NodeIndex node : from) {
            is_by_name() ? take_by_name(node, to, most) : take_by_scan(node, to, most);
            if (to.size() > most) {
                return status::Bad_TooManyMatches;
            }
            if (context_.visits_left == 0) {
                return status::Bad_QueryTooComplex;
            }
        }
        // A node that is reached twice counts once.
        if (from.size() > 1) {
            remove_duplicates(to);
        }
        return status::Good;
    }

private:
    [[nodiscard]] bool is_by_name() const
    {
        return !element_.is_inverse && type_ != model::no_node &&
               context_.space.is_subtype_of(type_, id::HierarchicalReferences);
    }
    void take_by_name(NodeIndex node, Level& to, std::size_t most)
    {
        const std::size_t visited = context_.space.for_each_child(
            node, type_, element_.include_subtypes, element_.target_name, [&](NodeIndex target) {
                add(target, to);
                return to.size() <= most;
            });
        static_cast<void>(context_.visit(visited + 1));
    }
    void take_by_scan(NodeIndex node, Level& to, std::size_t most)
    {
        model::ReferenceCursor cursor = context_.space.references(node);
        while (to.size() <= most && context_.visit(1)) {
            const auto reference = cursor.next();
            if (!reference) {
                return;
            }
            if (reference->is_forward != element_.is_inverse && fits(reference->type) &&
                context_.space.browse_name(reference->target) == element_.target_name) {
                add(reference->target, to);
            }
        }
    }
    [[nodiscard]] bool fits(NodeIndex reference) const
    {
        return type_ == model::no_node || reference == type_ ||
               (element_.include_subtypes && context_.space.is_subtype_of(reference, type_));
    }
    void add(NodeIndex target, Level& to) const
    {
        if (context_.may_see(target)) {
            to.push_back(target);
        }
    }
    static void remove_duplicates(Level& level)
    {
        std::size_t kept = 0;
        Level seen;
        for (const NodeIndex node : level) {
            const auto at = std::lower_bound(seen.begin(), seen.end(), node);
            if (at == seen.end() || *at != node) {
                seen.insert(at, node);
                level[kept++] = node;
            }
        }
        level.resize(kept);
    }

    ViewContext& context_;
    const RelativePathElement& element_;
    NodeIndex type_;
};

/// The nodes at the end of the path.
Result<Level> follow(ViewContext& context, const BrowsePath& path)
{
    const auto start = context.find(path.starting_node);
    if (!start) {
        return fail(start.error());
    }
    if (const StatusCode bad = check_path(context, path.relative_path); bad.is_bad()) {
        return fail(bad);
    }
    Level level{*start};
    for (const RelativePathElement& element : path.relative_path.elements) {
        Step step{context, element};
        if (const StatusCode bad = step.check(); bad.is_bad()) {
            return fail(bad);
        }
        Level next;
        const StatusCode taken = step.take(level, next, context.limits.max_browse_path_targets);
        if (taken.is_bad()) {
            return fail(taken);
        }
        if (next.empty()) {
            return fail(status::Bad_NoMatch);
        }
        level = std::move(next);
    }
    return level;
}

} // namespace

StatusCode check_translate(const ViewContext& context,
                           const TranslateBrowsePathsToNodeIdsRequest& request)
{
    const std::size_t count = request.browse_paths.size();
    if (count == 0) {
        return status::Bad_NothingToDo;
    }
    return count > context.limits.operations.max_nodes_per_translate_browse_paths
               ? status::Bad_TooManyOperations
               : status::Good;
}

BrowsePathResult translate_browse_path(ViewContext& context, const BrowsePath& path)
{
    BrowsePathResult result;
    const auto targets = follow(context, path);
    if (!targets) {
        result.status_code = targets.error();
        return result;
    }
    if (targets->size() > context.references_left) {
        result.status_code = status::Bad_QueryTooComplex;
        return result;
    }
    context.references_left -= targets->size();
    result.targets.reserve(targets->size());
    for (const NodeIndex target : *targets) {
        BrowsePathTarget& to = result.targets.emplace_back();
        to.target_id.node_id = context.space.node_id(target);
        // The whole path was followed (Part 4, 5.9.4.2).
        to.remaining_path_index = UINT32_MAX;
    }
    return result;
}

} // namespace busbar::server::detail

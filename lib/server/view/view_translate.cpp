#include <algorithm>
#include <utility>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/types/ids.hpp>

#include "view_context.hpp"

namespace busbar::server::detail {

namespace {

using model::NodeIndex;

/// Nodes at one level of a path, which may be removed between two turns.
using Level = std::vector<model::NodeHandle>;

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
    /// Good when `from` is empty, Good_CallAgain if the turn ends before. Else Bad_TooManyMatches
    /// past `most` targets, Bad_QueryTooComplex past the work that one request may cause.
    [[nodiscard]] StatusCode take(Level& from, Level& to, std::size_t most)
    {
        while (!from.empty()) {
            const NodeIndex node = context_.space.resolve(from.back());
            from.pop_back();
            if (node == model::no_node) {
                continue;
            }
            context_.add_late_nodes(node);
            const std::size_t before = context_.visits_left;
            is_by_name() ? take_by_name(node, to, most) : take_by_scan(node, to, most);
            context_.turn.spend(before - context_.visits_left);
            if (to.size() > most) {
                return status::Bad_TooManyMatches;
            }
            if (context_.visits_left == 0) {
                return status::Bad_QueryTooComplex;
            }
            if (context_.turn.is_over() && !from.empty()) {
                return status::Good_CallAgain;
            }
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
            to.push_back(context_.space.handle(target));
        }
    }

    ViewContext& context_;
    const RelativePathElement& element_;
    NodeIndex type_;
};

/// A node that is reached twice counts once.
void remove_duplicates(Level& level)
{
    std::size_t kept = 0;
    std::vector<NodeIndex> seen;
    for (const model::NodeHandle& node : level) {
        const auto at = std::lower_bound(seen.begin(), seen.end(), node.index);
        if (at == seen.end() || *at != node.index) {
            seen.insert(at, node.index);
            level[kept++] = node;
        }
    }
    level.resize(kept);
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

StatusCode PathWalk::begin(const ViewContext& context, const BrowsePath& path)
{
    const auto start = context.find(path.starting_node);
    if (!start) {
        return start.error();
    }
    from_ = {context.space.handle(*start)};
    return check_path(context, path.relative_path);
}

StatusCode PathWalk::follow(ViewContext& context, const BrowsePath& path)
{
    if (!std::exchange(has_begun_, true)) {
        if (const StatusCode bad = begin(context, path); bad.is_bad()) {
            return bad;
        }
    }
    for (; element_ < path.relative_path.elements.size(); ++element_) {
        Step step{context, path.relative_path.elements[element_]};
        if (const StatusCode bad = step.check(); bad.is_bad()) {
            return bad;
        }
        const StatusCode taken = step.take(from_, to_, context.limits.max_browse_path_targets);
        if (taken != StatusCode{status::Good}) {
            return taken;
        }
        if (to_.empty()) {
            return status::Bad_NoMatch;
        }
        remove_duplicates(to_);
        from_.assign(to_.rbegin(), to_.rend());
        to_.clear();
    }
    return status::Good;
}

std::optional<BrowsePathResult> PathWalk::go_on(ViewContext& context, const BrowsePath& path)
{
    BrowsePathResult result;
    result.status_code = follow(context, path);
    if (result.status_code == StatusCode{status::Good_CallAgain}) {
        return std::nullopt;
    }
    if (result.status_code.is_bad()) {
        return result;
    }
    std::erase_if(from_, [&context](const model::NodeHandle& target) {
        return context.space.resolve(target) == model::no_node; // removed since it was found
    });
    if (from_.empty()) {
        result.status_code = status::Bad_NoMatch;
        return result;
    }
    if (from_.size() > context.references_left) {
        result.status_code = status::Bad_QueryTooComplex;
        return result;
    }
    context.references_left -= from_.size();
    result.targets.reserve(from_.size());
    for (auto target = from_.rbegin(); target != from_.rend(); ++target) {
        BrowsePathTarget& to = result.targets.emplace_back();
        // A copy: the node may be removed before the response has all of its paths.
        const NodeId id = context.space.node_id(target->index);
        to.target_id.node_id = id;
        context.text_bytes += id.is_numeric() ? 0 : binary::encoded_size(id);
        // The whole path was followed (Part 4, 5.9.4.2).
        to.remaining_path_index = UINT32_MAX;
    }
    return result;
}

} // namespace busbar::server::detail

#include <algorithm>

#include <busbar/types/ids.hpp>

#include "hierarchy.hpp"
#include "view_context.hpp"
#include "view_part.hpp"

namespace busbar::server::detail {

namespace {

using model::NodeIndex;
using model::Reference;
using model::ReferenceCursor;

constexpr bool has(std::uint32_t mask, BrowseResultMask bit)
{
    return (mask & static_cast<std::uint32_t>(bit)) != 0;
}

/// True if the View contains the target of a reference of a node that it contains. What it contains
/// is reached from the View node along forward hierarchical references (Part 3, 5.4).
bool is_in_view(ViewContext& context, NodeIndex view, const Reference& reference)
{
    const model::AddressSpace& space = context.space;
    return (reference.is_forward &&
            space.is_subtype_of(reference.type, id::HierarchicalReferences)) ||
           is_below(space, reference.target, view, space.find(id::HierarchicalReferences),
                    context.visits_left);
}

/// True for the references that the client asked for and may know of.
bool matches(ViewContext& context, const BrowseFilter& filter, const Reference& reference)
{
    if (filter.direction != BrowseDirection::Both &&
        reference.is_forward != (filter.direction == BrowseDirection::Forward)) {
        return false;
    }
    const model::AddressSpace& space = context.space;
    if (filter.reference_type != model::no_node && reference.type != filter.reference_type &&
        !(filter.include_subtypes && space.is_subtype_of(reference.type, filter.reference_type))) {
        return false;
    }
    if (filter.node_class_mask != 0 &&
        (filter.node_class_mask & static_cast<std::uint32_t>(space.node_class(reference.target))) ==
            0) {
        return false;
    }
    return context.may_see(reference.target) && (filter.view.index == model::no_node ||
                                                 is_in_view(context, filter.view.index, reference));
}

/// Only what the ResultMask asks for; the rest stays null (Part 4, 5.9.2.2).
void describe(const model::AddressSpace& space, const Reference& reference, std::uint32_t mask,
              ReferenceDescription& to)
{
    to.node_id.node_id = space.node_id(reference.target);
    if (has(mask, BrowseResultMask::ReferenceTypeId)) {
        to.reference_type_id = space.node_id(reference.type);
    }
    if (has(mask, BrowseResultMask::IsForward)) {
        to.is_forward = reference.is_forward;
    }
    const NodeClass node_class = space.node_class(reference.target);
    if (has(mask, BrowseResultMask::NodeClass)) {
        to.node_class = node_class;
    }
    if (has(mask, BrowseResultMask::BrowseName)) {
        to.browse_name = space.browse_name(reference.target);
    }
    if (has(mask, BrowseResultMask::DisplayName)) {
        to.display_name = space.display_name(reference.target);
    }
    if (has(mask, BrowseResultMask::TypeDefinition) &&
        (node_class == NodeClass::Object || node_class == NodeClass::Variable)) {
        const NodeIndex type = space.type_definition(reference.target);
        to.type_definition.node_id = type == model::no_node ? NodeId{} : space.node_id(type);
    }
}

/// The references of a node, followed by the instances of one that is a type.
struct Walk {
    ReferenceCursor cursor;
    NodeIndex type;
    /// As BrowseState::instances.
    NodeIndex instances;
};

/// The next reference that matches; `walk` stands behind it.
std::optional<Reference> next_match(ViewContext& context, const BrowseFilter& filter, Walk& walk)
{
    while (const auto reference = walk.cursor.next()) {
        if (matches(context, filter, *reference)) {
            return reference;
        }
        if (!context.visit(1)) {
            return std::nullopt;
        }
    }
    const NodeIndex has_type_definition = context.space.find(id::HasTypeDefinition);
    while (walk.instances != model::no_node && context.visits_left != 0) {
        const NodeIndex instance =
            context.space.next_instance(walk.type, walk.instances, context.visits_left);
        const Reference reference{has_type_definition, instance, false};
        if (instance != model::no_node && matches(context, filter, reference)) {
            return reference;
        }
    }
    return std::nullopt;
}

/// How many references match, up to `most`, so that the answer is allocated once. If there are
/// none, `walk` stands behind what was looked at.
std::size_t count_matches(ViewContext& context, const BrowseFilter& filter, Walk& walk,
                          std::size_t most)
{
    Walk ahead = walk;
    std::size_t count = 0;
    while (count < most && context.visit(1) && next_match(context, filter, ahead)) {
        ++count;
    }
    if (count == 0 && most != 0) {
        walk = ahead;
    }
    return count;
}

/// Where to begin to look for instances: nowhere if the client did not ask for them.
NodeIndex first_instance(const model::AddressSpace& space, NodeIndex node,
                         const BrowseFilter& filter)
{
    const NodeClass node_class = space.node_class(node);
    const NodeIndex has_type_definition = space.find(id::HasTypeDefinition);
    const bool is_asked_for =
        (node_class == NodeClass::ObjectType || node_class == NodeClass::VariableType) &&
        filter.direction != BrowseDirection::Forward &&
        (filter.reference_type == model::no_node || filter.reference_type == has_type_definition ||
         (filter.include_subtypes &&
          space.is_subtype_of(has_type_definition, filter.reference_type)));
    return is_asked_for ? NodeIndex{0} : model::no_node;
}

/// Fills `result` from where `state` stands and leaves a continuation point if more is to come.
void continue_browse(ViewContext& context, BrowseState state, BrowseResult& result)
{
    const NodeIndex node = context.space.resolve(state.node);
    const std::size_t most = std::min<std::size_t>(state.max_references, context.references_left);
    Walk walk{context.space.references(node, state.position), node, state.instances};
    // Instances are too much work to look for them twice.
    const bool is_counted = state.instances == model::no_node;
    const std::size_t count = is_counted ? count_matches(context, state.filter, walk, most) : most;
    result.references.reserve(is_counted ? count : 0);
    while (result.references.size() < count) {
        const auto reference = next_match(context, state.filter, walk);
        if (!reference) {
            break;
        }
        describe(context.space, *reference, state.filter.result_mask,
                 result.references.emplace_back());
    }
    context.references_left -= result.references.size();
    state.position = walk.cursor.position();
    state.instances = walk.instances;
    const bool is_complete = context.visits_left != 0 && !next_match(context, state.filter, walk) &&
                             context.visits_left != 0;
    if (is_complete) {
        return;
    }
    ViewPart& part = ViewPart::of(context.session);
    auto point = part.add(context.session, context.random, state,
                          context.limits.max_browse_continuation_points);
    if (!point) {
        context.references_left += result.references.size();
        result = BrowseResult{};
        result.status_code = point.error();
        return;
    }
    result.continuation_point = std::move(*point);
}

Result<BrowseFilter> make_filter(const ViewContext& context, const BrowseDescription& description)
{
    if (description.browse_direction < BrowseDirection::Forward ||
        description.browse_direction > BrowseDirection::Both) {
        return fail(status::Bad_BrowseDirectionInvalid);
    }
    BrowseFilter filter{model::no_node,
                        description.include_subtypes,
                        description.browse_direction,
                        description.node_class_mask,
                        description.result_mask,
                        {}};
    if (!description.reference_type_id.is_null()) {
        filter.reference_type = context.space.find(description.reference_type_id);
        if (filter.reference_type == model::no_node ||
            context.space.node_class(filter.reference_type) != NodeClass::ReferenceType) {
            return fail(status::Bad_ReferenceTypeIdInvalid);
        }
    }
    return filter;
}

/// The node if there is one in the View, or in the address space if that is no_node.
Result<NodeIndex> find_in_view(ViewContext& context, const NodeId& id, NodeIndex view)
{
    auto node = context.find(id);
    const bool is_outside =
        node && view != model::no_node &&
        !is_below(context.space, *node, view, context.space.find(id::HierarchicalReferences),
                  context.visits_left);
    return is_outside ? fail(status::Bad_NodeNotInView) : std::move(node);
}

void browse_node(ViewContext& context, const BrowseDescription& description, NodeIndex view,
                 std::uint32_t max_references, BrowseResult& result)
{
    const auto node = find_in_view(context, description.node_id, view);
    auto filter = node ? make_filter(context, description) : fail(node.error());
    if (!filter) {
        result.status_code = filter.error();
        return;
    }
    if (view != model::no_node) {
        filter->view = context.space.handle(view);
    }
    continue_browse(context,
                    {context.space.handle(*node), *filter, max_references, 0,
                     context.space.reference_epoch(),
                     first_instance(context.space, *node, *filter)},
                    result);
}

/// The value of the View's property ViewVersion, 0 if it has none.
std::uint32_t version_of(const model::AddressSpace& space, NodeIndex view)
{
    std::uint32_t version = 0;
    space.for_each_child(view, space.find(id::HasProperty), true, QualifiedName{0, "ViewVersion"},
                         [&](NodeIndex property) {
                             version = space.value(property).value_or(std::uint32_t{0});
                             return false;
                         });
    return version;
}

/// There are only Views as they are now, and no times of theirs are kept (Part 4, 7.45).
StatusCode check_view(const ViewContext& context, const ViewDescription& view)
{
    if (view.view_id.is_null()) {
        return status::Good;
    }
    const auto node = context.find(view.view_id);
    if (!node || context.space.node_class(*node) != NodeClass::View) {
        return status::Bad_ViewIdUnknown;
    }
    const bool has_time = !view.timestamp.is_null();
    if (has_time && view.view_version != 0) {
        return status::Bad_ViewParameterMismatch;
    }
    if (has_time) {
        return status::Bad_ViewTimestampInvalid;
    }
    const bool is_present =
        view.view_version == 0 || view.view_version == version_of(context.space, *node);
    return is_present ? status::Good : status::Bad_ViewVersionInvalid;
}

/// False if the View is gone that a Browse was made in.
bool has_its_view(const model::AddressSpace& space, const BrowseFilter& filter)
{
    return filter.view.index == model::no_node || space.resolve(filter.view) != model::no_node;
}

} // namespace

StatusCode browse(ViewContext& context, const BrowseRequest& request, BrowseResponse& response)
{
    const std::size_t count = request.nodes_to_browse.size();
    if (count == 0) {
        return status::Bad_NothingToDo;
    }
    if (count > context.limits.operations.max_nodes_per_browse) {
        return status::Bad_TooManyOperations;
    }
    if (const StatusCode bad = check_view(context, request.view); bad.is_bad()) {
        return bad;
    }
    const std::uint32_t requested = request.requested_max_references_per_node;
    const std::uint32_t most = requested == 0
                                   ? context.limits.max_references_per_node
                                   : std::min(requested, context.limits.max_references_per_node);
    const NodeIndex view =
        request.view.view_id.is_null() ? model::no_node : context.space.find(request.view.view_id);
    ViewPart::of(context.session).begin_request();
    response.results.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        browse_node(context, request.nodes_to_browse[i], view, most, response.results[i]);
    }
    return status::Good;
}

StatusCode browse_next(ViewContext& context, const BrowseNextRequest& request,
                       BrowseNextResponse& response)
{
    const std::size_t count = request.continuation_points.size();
    if (count == 0) {
        return status::Bad_NothingToDo;
    }
    if (count > context.limits.operations.max_nodes_per_browse) {
        return status::Bad_TooManyOperations;
    }
    ViewPart& part = ViewPart::of(context.session);
    part.begin_request();
    if (request.release_continuation_points) {
        for (const ByteString& id : request.continuation_points) {
            static_cast<void>(part.take(context.session, id));
        }
        return status::Good;
    }
    response.results.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        BrowseResult& result = response.results[i];
        const auto state = part.take(context.session, request.continuation_points[i]);
        if (!state) {
            result.status_code = state.error();
        } else if (context.space.resolve(state->node) == model::no_node) {
            result.status_code = status::Bad_NodeIdUnknown;
        } else if (state->epoch != context.space.reference_epoch() ||
                   !has_its_view(context.space, state->filter)) {
            result.status_code = status::Bad_ContinuationPointInvalid;
        } else {
            continue_browse(context, *state, result);
        }
    }
    return status::Good;
}

} // namespace busbar::server::detail

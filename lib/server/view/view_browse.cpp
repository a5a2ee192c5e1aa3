#include <algorithm>
#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/types/ids.hpp>

#include "browse_work.hpp"
#include "server/rights/hierarchy.hpp"
#include "server/rights/live_values.hpp"

namespace busbar::server::detail {

namespace {

using model::NodeIndex;
using model::Reference;
using model::ReferenceCursor;

constexpr bool has(std::uint32_t mask, BrowseResultMask bit)
{
    return (mask & static_cast<std::uint32_t>(bit)) != 0;
}

/// True if the View contains the target of a reference of a node that it contains. Its nodes are
/// reached from the View node along forward hierarchical references (Part 3, 5.4).
bool is_in_view(ViewContext& context, NodeIndex view, const Reference& reference)
{
    const model::AddressSpace& space = context.space;
    return (reference.is_forward &&
            space.is_subtype_of(reference.type, id::HierarchicalReferences)) ||
           is_below(space, reference.target, view, space.find(id::HierarchicalReferences),
                    context.visits_left);
}

/// True for the references that the client requested and may see.
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

/// Describes only what the ResultMask requests; the rest stays null (Part 4, 5.9.2.2).
void describe(const ViewContext& context, const Reference& reference, std::uint32_t mask,
              ReferenceDescription& to)
{
    const model::AddressSpace& space = context.space;
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
        space.translate(reference.target, AttributeId::DisplayName, context.session.locale_ids,
                        to.display_name);
    }
    if (has(mask, BrowseResultMask::TypeDefinition) &&
        (node_class == NodeClass::Object || node_class == NodeClass::Variable)) {
        const NodeIndex type = space.type_definition(reference.target);
        to.type_definition.node_id = type == model::no_node ? NodeId{} : space.node_id(type);
    }
}

std::size_t text_size(const NodeId& id)
{
    return id.is_numeric() ? 0 : binary::encoded_size(id);
}

/// Returns the bytes of the description in addition to the object itself.
std::size_t text_size(const ReferenceDescription& described)
{
    return described.browse_name.name.size() + described.display_name.locale.size() +
           described.display_name.text.size() + text_size(described.node_id.node_id) +
           text_size(described.reference_type_id) + text_size(described.type_definition.node_id);
}

/// The references of a node, followed by the instances of a type.
struct Walk {
    ReferenceCursor cursor;
    NodeIndex type;
    /// The same as BrowseState::instances.
    NodeIndex instances;
};

/// Returns the next reference that matches and moves `walk` past it. None at the end, or when the
/// context must pause.
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
    while (walk.instances != model::no_node && context.may_go_on()) {
        std::size_t visits = context.visits_left - context.pause_at;
        const NodeIndex instance = context.space.next_instance(walk.type, walk.instances, visits);
        context.visits_left = context.pause_at + visits;
        const Reference reference{has_type_definition, instance, false};
        if (instance != model::no_node && matches(context, filter, reference)) {
            return reference;
        }
    }
    return std::nullopt;
}

/// Returns how many references match, up to `most`, so that the answer is allocated once. If none
/// match, `walk` is past the ones it visited.
std::size_t count_matches(ViewContext& context, const BrowseFilter& filter, Walk& walk,
                          std::size_t most)
{
    Walk ahead = walk;
    std::size_t count = 0;
    // The other half is for visiting them again.
    const std::size_t pause_at = std::exchange(
        context.pause_at, context.visits_left - (context.visits_left - context.pause_at) / 2);
    while (count < most && context.visit(1) && next_match(context, filter, ahead)) {
        ++count;
    }
    context.pause_at = pause_at;
    if (count == 0 && most != 0) {
        walk = ahead;
    }
    return count;
}

/// Returns where to begin the search for instances: no_node if the client did not request them.
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

/// Gives the client a continuation point for the rest.
void leave_point(ViewContext& context, const BrowseState& state, BrowseResult& result)
{
    ViewPart& part = ViewPart::of(context.session);
    auto point = part.add(context.session, context.random, context.space, state,
                          context.limits.max_browse_continuation_points);
    if (!point) {
        return take_back(context, result, point.error());
    }
    result.continuation_point = std::move(*point);
}

/// Reserves room for `size` of at most `most` references: exactly in the first turn, later for
/// twice as many, as each turn adds only a few to what may be very many.
void make_room(Array<ReferenceDescription>& references, std::size_t size, std::size_t most)
{
    if (size > references.capacity()) {
        references.reserve(std::max(size, std::min(most, 2 * references.size())));
    }
}

/// Adds matches to `result` until it has `most`, or until the turn ends.
void take_matches(ViewContext& context, const BrowseFilter& filter, Walk& walk, std::size_t most,
                  BrowseResult& result)
{
    const std::size_t has = result.references.size();
    const auto room = static_cast<std::ptrdiff_t>(result.references.capacity());
    std::size_t count = std::min(most - has, context.turn.left() / Turn::units_of_reference + 1);
    // Searching instances twice would take too long.
    if (walk.instances == model::no_node) {
        count = count_matches(context, filter, walk, count);
        make_room(result.references, has + count, most);
    }
    while (result.references.size() < has + count) {
        const auto reference = next_match(context, filter, walk);
        if (!reference) {
            break;
        }
        ReferenceDescription& described = result.references.emplace_back();
        describe(context, *reference, filter.result_mask, described);
        context.text_bytes += text_size(described);
        context.turn.spend(Turn::units_of_reference);
    }
    context.references_left -= result.references.size() - has;
    context.room += static_cast<std::ptrdiff_t>(result.references.capacity()) - room;
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

/// Returns the node if the View has it, or the address space if that is no_node.
Result<NodeIndex> find_in_view(ViewContext& context, const NodeId& id, NodeIndex view)
{
    auto node = context.find(id);
    const bool is_outside =
        node && view != model::no_node &&
        !is_below(context.space, *node, view, context.space.find(id::HierarchicalReferences),
                  context.visits_left);
    if (is_outside) {
        return fail(status::Bad_NodeNotInView);
    }
    return node;
}

} // namespace

void ViewContext::add_late_nodes(NodeIndex node)
{
    if (late_nodes == nullptr || space.node_class(node) != NodeClass::Variable) {
        return;
    }
    const model::VariableAttributes variable = space.variable(node);
    if (variable.source == live_values_source) {
        turn.spend(late_nodes->add_below(node, variable.handle) * Turn::units_of_reference);
    }
}

Result<BrowseState> begin_browse(ViewContext& context, const BrowseDescription& description,
                                 NodeIndex view, std::uint32_t max_references)
{
    const auto node = find_in_view(context, description.node_id, view);
    auto filter = node ? make_filter(context, description) : fail(node.error());
    if (!filter) {
        return fail(filter.error());
    }
    if (view != model::no_node) {
        filter->view = context.space.handle(view);
    }
    context.add_late_nodes(*node);
    return BrowseState{context.space.handle(*node), *filter, max_references, 0,
                       first_instance(context.space, *node, *filter)};
}

void take_back(ViewContext& context, BrowseResult& result, StatusCode status)
{
    context.references_left += result.references.size();
    context.room -= static_cast<std::ptrdiff_t>(result.references.capacity());
    result = BrowseResult{};
    result.status_code = status;
}

bool continue_browse(ViewContext& context, BrowseState& state, BrowseResult& result)
{
    const NodeIndex node = context.space.resolve(state.node);
    const std::size_t has = result.references.size();
    const std::size_t most =
        std::min<std::size_t>(state.max_references, context.references_left + has);
    Walk walk{context.space.references(node, state.position), node, state.instances};
    take_matches(context, state.filter, walk, most, result);
    state.position = walk.cursor.position();
    state.instances = walk.instances;
    const bool is_more = next_match(context, state.filter, walk).has_value();
    if (!is_more && context.may_go_on()) {
        return true;
    }
    if (!is_more) { // none of the visited ones matched
        state.position = walk.cursor.position();
        state.instances = walk.instances;
    }
    const bool is_full = result.references.size() == most && is_more;
    if (!is_full && context.visits_left != 0) {
        return false;
    }
    leave_point(context, state, result);
    return true;
}

} // namespace busbar::server::detail

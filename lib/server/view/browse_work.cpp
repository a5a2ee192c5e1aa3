#include "browse_work.hpp"

#include <algorithm>
#include <utility>

#include <busbar/types/ids.hpp>

#include "server/rights/nodes_ahead.hpp"

namespace busbar::server::detail {

namespace {

using model::NodeIndex;

/// Returns the View's property ViewVersion, 0 if it has none.
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

/// Views exist in their present state only, without earlier times (Part 4, 7.45).
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

/// Returns false if the View of a Browse was removed.
bool has_its_view(const model::AddressSpace& space, const BrowseFilter& filter)
{
    return filter.view.index == model::no_node || space.resolve(filter.view) != model::no_node;
}

/// Continues with a node that was begun; true once its result is complete.
bool go_on_with(ViewContext& context, BrowsePlace& place, BrowseResult& result)
{
    constexpr std::size_t least = 1'000; // to make progress
    const std::size_t before = context.visits_left;
    context.pause_at = before - std::min(before, std::max(context.turn.left(), least));
    const bool is_complete = continue_browse(context, *place.state, result);
    context.turn.spend(before - context.visits_left);
    place.watch.is_lost = false;
    if (is_complete) {
        place.state.reset();
        place.watch.stop();
    } else {
        context.space.journal().watch(place.state->node.index,
                                      model::NodeAspect::ReferencePositions, place.watch);
    }
    return is_complete;
}

/// Returns why the references of a node cannot be browsed any further; good if they can.
StatusCode check_place(const ViewContext& context, const BrowsePlace& place)
{
    if (context.space.resolve(place.state->node) == model::no_node) {
        return status::Bad_NodeIdUnknown;
    }
    const bool is_valid = !place.watch.is_lost && has_its_view(context.space, place.state->filter);
    return is_valid ? status::Good : status::Bad_ContinuationPointInvalid;
}

bool is_borrowed(const NodeId& id)
{
    switch (id.id_type()) {
    case IdType::String:
        return !id.string().is_owned();
    case IdType::Opaque:
        return !id.opaque().is_owned();
    default:
        return false;
    }
}

bool is_borrowed(const ReferenceDescription& described)
{
    return !described.browse_name.name.is_owned() || !described.display_name.text.is_owned() ||
           !described.display_name.locale.is_owned() || is_borrowed(described.node_id.node_id) ||
           is_borrowed(described.reference_type_id) ||
           is_borrowed(described.type_definition.node_id);
}

/// Gives results after `kept`, up to and including the unfinished one, texts of their own: the
/// nodes whose texts they borrow may be removed before the next turn.
void keep_results(Array<BrowseResult>& results, BrowseKept& kept, std::size_t next)
{
    for (; kept.result <= next && kept.result < results.size(); ++kept.result) {
        const auto references = results[kept.result].references.span();
        for (; kept.references < references.size(); ++kept.references) {
            ReferenceDescription& described = references[kept.references];
            if (is_borrowed(described)) {
                ReferenceDescription own{std::as_const(described)}; // a copy owns its memory
                described = std::move(own);
            }
        }
        if (kept.result == next) { // it is unfinished
            return;
        }
        kept.references = 0;
    }
}

/// Drops the result of a node that cannot be browsed any further.
void give_up(ViewContext& context, BrowsePlace& place, BrowseResult& result, StatusCode status)
{
    take_back(context, result, status);
    place.state.reset();
}

} // namespace

StatusCode BrowseWork::begin(ViewContext& context, const BrowseRequest& request,
                             BrowseResponse& response)
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
    max_references_ = requested == 0 ? context.limits.max_references_per_node
                                     : std::min(requested, context.limits.max_references_per_node);
    ViewPart::of(context.session).begin_request();
    response.results.reserve(count, context.memory);
    response.results.resize(count);
    return status::Good;
}

bool BrowseWork::go_on(ViewContext& context, const BrowseRequest& request, BrowseResponse& response)
{
    const bool is_complete = take_turn(context, request, response);
    if (!is_complete) {
        keep_results(response.results, kept_, next_);
    }
    return is_complete;
}

void BrowseWork::undo(Session& session) const
{
    ViewPart::Points none;
    ViewPart::of(session).take_back(session, none);
}

bool BrowseWork::take_turn(ViewContext& context, const BrowseRequest& request,
                           BrowseResponse& response)
{
    // Looked up in each turn: its index may change, or it may be removed.
    view_ =
        request.view.view_id.is_null() ? model::no_node : context.space.find(request.view.view_id);
    while (next_ < response.results.size()) {
        if (context.turn.is_over()) {
            return false;
        }
        BrowseResult& result = response.results[next_];
        if (place_.state && check_place(context, place_).is_bad()) {
            give_up(context, place_, result, status::Good); // and start it again
            kept_.references = kept_.result == next_ ? 0 : kept_.references;
        }
        if (!place_.state) {
            fetch_ahead(
                context.space, request.nodes_to_browse.span(), next_,
                [](const BrowseDescription& node) -> const NodeId& { return node.node_id; });
            auto begun =
                begin_browse(context, request.nodes_to_browse[next_], view_, max_references_);
            if (!begun) {
                result.status_code = begun.error();
                ++next_;
                continue;
            }
            place_.state = *begun;
        }
        if (go_on_with(context, place_, result)) {
            ++next_;
        }
    }
    return true;
}

StatusCode BrowseNextWork::begin(ViewContext& context, const BrowseNextRequest& request,
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
            static_cast<void>(part.take(context.session, id, used_));
        }
        return status::Good; // and no results
    }
    response.results.reserve(count, context.memory);
    response.results.resize(count);
    return status::Good;
}

bool BrowseNextWork::go_on(ViewContext& context, const BrowseNextRequest& request,
                           BrowseNextResponse& response)
{
    const bool is_complete = take_turn(context, request, response);
    if (!is_complete) {
        keep_results(response.results, kept_, next_);
    }
    return is_complete;
}

void BrowseNextWork::undo(Session& session)
{
    ViewPart::of(session).take_back(session, used_);
}

bool BrowseNextWork::take_turn(ViewContext& context, const BrowseNextRequest& request,
                               BrowseNextResponse& response)
{
    while (next_ < response.results.size()) {
        if (context.turn.is_over()) {
            return false;
        }
        BrowseResult& result = response.results[next_];
        if (!place_.state) {
            auto taken = ViewPart::of(context.session)
                             .take(context.session, request.continuation_points[next_], used_);
            if (!taken) {
                result.status_code = taken.error();
                ++next_;
                continue;
            }
            place_.state = *taken;
        }
        if (const StatusCode bad = check_place(context, place_); bad.is_bad()) {
            give_up(context, place_, result, bad);
            ++next_;
        } else if (go_on_with(context, place_, result)) {
            ++next_;
        }
    }
    return true;
}

} // namespace busbar::server::detail

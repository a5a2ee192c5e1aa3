#include "event_item.hpp"

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/types/subscription.hpp>

#include "server/data/read_results.hpp"
#include "server/subscription/sampling_context.hpp"
#include "server/subscription/subscription.hpp"
#include "server/subscription/subscription_table.hpp"

namespace busbar::server::detail {

namespace {

/// The size that a requested 0 means (Part 4, 7.21).
constexpr std::uint32_t default_queue_size = 1'000;

std::uint32_t revise_queue_size(std::uint32_t requested, std::uint32_t most)
{
    return std::min(requested == 0 ? default_queue_size : requested, most);
}

/// Returns Good if it is a node whose events the user may subscribe to.
StatusCode check_notifier(const ItemContext& context, const ReadValueId& id)
{
    constexpr std::uint8_t subscribe_to_events = 1; // EventNotifierType (Part 3, 8.59)
    const ReadPlan plan = plan_sample(context.all.needs(), context.subscription, id);
    if (plan.answer.status.is_bad()) {
        return plan.answer.status;
    }
    const NodeRights rights = context.subscription.rights();
    const model::NodeIndex node = context.all.needs().space.find(id.node_id);
    if (const StatusCode weak = rights.check_channel(node); weak.is_bad()) {
        return weak;
    }
    if (!rights.is_permitted(PermissionType::ReceiveEvents, node)) {
        return status::Bad_UserAccessDenied;
    }
    if (!id.index_range.empty()) { // the attribute is a number, not an array of them
        return NumericRange::parse(id.index_range.view()) ? status::Bad_IndexRangeNoData
                                                          : status::Bad_IndexRangeInvalid;
    }
    const auto notifier = plan.answer.value.value_or<std::uint8_t>(0);
    return (notifier & subscribe_to_events) != 0 ? status::Good : status::Bad_NotSupported;
}

/// Returns the fields with Bad_EncodingError in place of those with a text that is not UTF-8 (Part
/// 6, 5.2.2.4).
EventItemQueue::Fields with_valid_texts(EventItemQueue::Fields fields)
{
    for (Variant& field : fields) {
        if (!has_valid_texts(field)) {
            field = Variant{status::Bad_EncodingError};
        }
    }
    return fields;
}

/// Returns the fields with Bad_EncodingLimitsExceeded in place of as many of the largest as are
/// needed to save `excess` bytes (Part 4, 7.22.3).
EventItemQueue::Fields without_largest(EventItemQueue::Fields fields, std::size_t excess)
{
    const Variant reason{status::Bad_EncodingLimitsExceeded};
    const std::size_t reason_size = binary::encoded_size(reason);
    std::vector<std::pair<std::size_t, Variant*>> by_size;
    for (Variant& field : fields) {
        by_size.emplace_back(binary::encoded_size(field), &field);
    }
    std::sort(by_size.begin(), by_size.end(), std::greater{});
    for (const auto& [size, field] : by_size) {
        if (excess == 0 || size <= reason_size) {
            break;
        }
        *field = reason;
        excess -= std::min(excess, size - reason_size);
    }
    return fields;
}

} // namespace

EventItem::EventItem(Events& events, const ItemContext& context,
                     const MonitoredItemCreateRequest& request, model::NodeHandle notifier,
                     ItemRevision& revision)
    : MonitoredItem{context.subscription, Kind::Event, request.requested_parameters.client_handle,
                    request.monitoring_mode},
      EventReceiver{notifier}, events_{events}, needs_{context.all.needs()},
      queue_{context.subscription.memory()}
{
    set(request.requested_parameters, revision);
    if (revision.status.is_good() && mode() != MonitoringMode::Disabled) {
        events_.add(*this);
    }
}

EventItem::~EventItem()
{
    events_.remove(*this);
    subscription().memory().release(paid_);
}

void EventItem::set(const MonitoringParameters& parameters, ItemRevision& revision)
{
    revision.status = take_filter(parameters.filter, revision);
    if (revision.status.is_bad()) {
        return;
    }
    set_client_handle(parameters.client_handle);
    revision.queue_size =
        revise_queue_size(parameters.queue_size, needs_.limits.subscriptions.max_event_queue_size);
    if (!queue_.set_capacity(revision.queue_size, parameters.discard_oldest)) {
        queue_overflow();
    }
}

StatusCode EventItem::take_filter(const ExtensionObject& filter, ItemRevision& revision)
{
    const auto* const requested = filter.get_if<EventFilter>();
    if (requested == nullptr) {
        const bool is_other =
            filter.get_if<DataChangeFilter>() != nullptr || filter.get_if<AggregateFilter>();
        return is_other ? status::Bad_FilterNotAllowed : status::Bad_MonitoredItemFilterInvalid;
    }
    CompiledEventFilter compiled;
    EventFilterResult result;
    const StatusCode code =
        compiled.compile(*requested, events_.fields(), events_.limits().filter, result);
    if (result != EventFilterResult{}) {
        revision.filter_result = ExtensionObject::from(std::move(result));
    }
    if (code.is_bad()) {
        return code;
    }
    // Includes the overflow event, which can then always be queued.
    const std::size_t cost = sizeof(EventItem) + compiled.memory() + 256 +
                             requested->select_clauses.size() * sizeof(Variant);
    if (!subscription().memory().charge(cost)) {
        return status::Bad_TooManyMonitoredItems;
    }
    subscription().memory().release(std::exchange(paid_, cost));
    filter_ = std::move(compiled);
    return status::Good;
}

void EventItem::deliver(const RaisedEvent& event)
{
    if (!may_receive_ || !may_know_of(event.type())) {
        return;
    }
    filter_.follow(events_.fields());
    const NodeRights rights = subscription().rights();
    const EventReader reader{needs_.space, &rights};
    if (!filter_.matches(event, reader)) {
        return;
    }
    if (!queue_.push(with_valid_texts(filter_.select(event, reader)), event.type(),
                     filter_.has_guards())) {
        queue_overflow();
    }
    notify();
}

/// Checks the RolePermissions of event types (Part 3, 4.9); audit events go only over channels with
/// encryption and to users who may receive AuditEvents at all (Part 5, 6.4.3), whatever a subtype
/// allows.
bool EventItem::may_know_of(model::NodeIndex type) const
{
    const NodeRights rights = subscription().rights();
    if (!rights.is_permitted(PermissionType::ReceiveEvents, type)) {
        return false;
    }
    const model::NodeIndex audit = needs_.space.find(id::AuditEventType);
    return !needs_.space.is_subtype_of(type, audit) ||
           (rights.security_mode == MessageSecurityMode::SignAndEncrypt &&
            rights.is_permitted(PermissionType::ReceiveEvents, audit));
}

void EventItem::tell_of_loss()
{
    if (may_receive_) {
        queue_overflow();
        notify();
    }
}

/// The overflow event bypasses the whereClause (Part 4, 7.22.3).
void EventItem::queue_overflow()
{
    if (!owes_overflow_ && queue_.wants_overflow()) {
        subscription().count(&SubscriptionDiagnosticsDataType::event_queue_overflow_count);
        owes_overflow_ = true;
        busbar::detail::attempt([&] { pay_overflow(); });
    }
}

void EventItem::pay_overflow()
{
    if (owes_overflow_) {
        filter_.follow(events_.fields());
        const NodeRights rights = subscription().rights();
        queue_.push_overflow(
            filter_.select(*events_.overflow_event(), EventReader{needs_.space, &rights}));
        owes_overflow_ = false;
    }
}

std::size_t EventItem::notification_size() const
{
    // The item has paid for more than the size of an overflow event.
    return (owes_overflow_ ? paid_ : 0) +
           (queue_.size() != 0 ? binary::encoded_size(client_handle(), queue_.oldest()) : 0);
}

void EventItem::take_notification(binary::Writer& writer, std::size_t most)
{
    pay_overflow();
    // An EventFieldList (Part 4, 7.25.3), encoded from the fields in place.
    encode(writer, client_handle());
    const std::size_t size = notification_size();
    if (size <= most) {
        encode(writer, queue_.oldest());
    } else {
        encode(writer, without_largest(queue_.oldest(), size - most));
    }
    queue_.pop();
    subscription().count(&SubscriptionDiagnosticsDataType::event_notifications_count);
}

void EventItem::modify(const ItemContext&, const MonitoringParameters& parameters,
                       TimestampsToReturn, ItemRevision& revision)
{
    set(parameters, revision);
    if (revision.status.is_good() && queued() != 0) {
        notify();
    }
}

void EventItem::user_changed(const ItemContext& context)
{
    const NodeRights rights = context.subscription.rights();
    const model::NodeIndex node = needs_.space.resolve(notifier());
    may_receive_ = node != model::no_node && rights.may_see(node) &&
                   rights.is_permitted(PermissionType::ReceiveEvents, node) &&
                   rights.check_channel(node).is_good();
    if (!may_receive_) {
        // The new user must not see events that the previous one was allowed to see.
        clear();
        subscription().ready(Kind::Event).remove(*this);
    } else if (queue_.discard_guarded([this](auto type) { return may_know_of(type); })) {
        queue_overflow(); // they were selected for the previous user
        notify();
    }
}

void EventItem::mode_changed(const ItemContext&, MonitoringMode before)
{
    if (before == MonitoringMode::Disabled) {
        events_.add(*this);
    } else if (mode() == MonitoringMode::Disabled) {
        events_.remove(*this);
    }
}

std::unique_ptr<MonitoredItem> EventItemMaker::make(const ItemContext& context,
                                                    const MonitoredItemCreateRequest& request,
                                                    ItemRevision& revision)
{
    revision.status = check_notifier(context, request.item_to_monitor);
    if (revision.status.is_bad()) {
        return nullptr;
    }
    const model::AddressSpace& space = context.all.needs().space;
    const model::NodeIndex node = space.find(request.item_to_monitor.node_id);
    auto item =
        std::make_unique<EventItem>(events_, context, request, space.handle(node), revision);
    return revision.status.is_good() ? std::move(item) : nullptr;
}

} // namespace busbar::server::detail

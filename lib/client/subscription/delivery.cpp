#include "reception.hpp"

namespace busbar::client::detail {

Delivery::Delivery(WatchList& subscriptions, ItemTable& items, SubscriptionEnds& ends,
                   PublishQueue& publishes)
    : subscriptions_{subscriptions}, items_{items}, ends_{ends}, publishes_{publishes}
{
}

void Delivery::deliver(WatchedSubscription& subscription, const NotificationMessage& message)
{
    const SubscriptionHandle handle = subscription.handle;
    const std::uint32_t incarnation = subscription.incarnation;
    const std::uint32_t server_id = subscription.server_id;
    subscription.report_gap(message.publish_time);
    StatusCode change;
    for (const ExtensionObject& part : message.notification_data) {
        if (const auto* data = part.get_if<DataChangeNotification>()) {
            deliver_data(handle, *data);
        } else if (const auto* events = part.get_if<EventNotificationList>()) {
            deliver_events(handle, *events);
        } else if (const auto* status = part.get_if<StatusChangeNotification>()) {
            change = status->status;
        } else if (WatchedSubscription* rest = subscriptions_.find(handle, incarnation)) {
            rest->lose(status::Bad_DecodingError); // whatever it was
        }
    }
    WatchedSubscription* rest = subscriptions_.find(handle, incarnation);
    if (rest == nullptr) {
        return;
    }
    rest->failures = 0;
    rest->messages.complete_until = message.publish_time;
    publishes_.acknowledge(server_id, message.sequence_number);
    // Part 4, 7.25.4: it has ended, by its lifetime or because another session has it now.
    if (change.is_bad() || change == status::Good_SubscriptionTransferred) {
        ends_.lost(*rest, change, false);
    }
}

void Delivery::deliver_data(SubscriptionHandle handle, const DataChangeNotification& notification)
{
    const WatchedSubscription* subscription = subscriptions_.find(handle);
    if (subscription == nullptr || !subscription->handlers->on_data) {
        return;
    }
    std::vector<DataChange> changes;
    changes.reserve(notification.monitored_items.size());
    for (const MonitoredItemNotification& change : notification.monitored_items) {
        Item* item = items_.find(change.client_handle);
        if (item != nullptr && item->subscription == handle) {
            item->told_after = subscription->refresh.losses;
            changes.push_back({change.client_handle, change.value});
        }
    }
    const auto handlers = subscription->handlers;
    if (!changes.empty()) {
        handlers->on_data(changes);
    }
}

void Delivery::deliver_events(SubscriptionHandle handle, const EventNotificationList& notification)
{
    const WatchedSubscription* subscription = subscriptions_.find(handle);
    if (subscription == nullptr || !subscription->handlers->on_events) {
        return;
    }
    std::vector<EventArrived> arrived;
    arrived.reserve(notification.events.size());
    for (const EventFieldList& event : notification.events) {
        const Item* item = items_.find(event.client_handle);
        if (item != nullptr && item->subscription == handle) {
            arrived.push_back({event.client_handle, event.event_fields});
        }
    }
    const auto handlers = subscription->handlers;
    if (!arrived.empty()) {
        handlers->on_events(arrived);
    }
}

} // namespace busbar::client::detail

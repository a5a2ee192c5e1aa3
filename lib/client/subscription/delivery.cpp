#include <algorithm>

#include "engine.hpp"

namespace busbar::client::detail {

void SubscriptionEngine::receive(PublishResponse response)
{
    const auto found = by_server_id_.find(response.subscription_id);
    if (found == by_server_id_.end()) {
        // One of an earlier life. What is being made or transferred may answer before that does.
        const bool may_become_ours =
            std::any_of(subscriptions_.begin(), subscriptions_.end(), [](const auto& entry) {
                return entry.second.phase == Phase::Creating ||
                       entry.second.phase == Phase::Transferring;
            });
        if (!may_become_ours) {
            doom(response.subscription_id);
        }
        return;
    }
    const SubscriptionHandle handle = found->second;
    WatchedSubscription& subscription = *find(handle);
    NotificationMessage message = std::move(response.notification_message);
    if (message.publish_time.is_null()) {
        message.publish_time = response.response_header.timestamp;
    }
    heard(subscription, message.publish_time);
    if (!message.notification_data.empty()) {
        accept(handle, std::move(message));
    } else if (!subscription.sequence.expect_before(message.sequence_number)) {
        // Part 4, 5.14.1.1: a keep-alive message has the number of the next message.
        jump_to(handle, message.sequence_number);
    }
    settle(handle);
}

void SubscriptionEngine::heard(WatchedSubscription& subscription, DateTime time)
{
    subscription.heard_time = time;
    subscription.silences = 0;
    // Half as long again, and what a slow link may take.
    subscription.silent_at = requester_.now() + subscription.keep_alive_interval +
                             subscription.keep_alive_interval / 2 + std::chrono::seconds{1};
}

void SubscriptionEngine::accept(SubscriptionHandle handle, NotificationMessage message)
{
    WatchedSubscription& subscription = *find(handle);
    const std::uint32_t number = message.sequence_number;
    switch (subscription.sequence.put(message)) {
    case SequenceTracker::Arrival::Duplicate:
        acknowledge(subscription.server_id, number); // it was delivered; the server may forget it
        break;
    case SequenceTracker::Arrival::TooFar:
        jump_to(handle, number);
        if (WatchedSubscription* rest = find(handle)) {
            rest->sequence.put(message);
        }
        break;
    case SequenceTracker::Arrival::Kept:
    case SequenceTracker::Arrival::Repeated:
        break;
    }
    deliver_kept(handle);
}

/// Gives up all that is missing before `sequence_number`, and delivers what is here of it.
void SubscriptionEngine::jump_to(SubscriptionHandle handle, std::uint32_t sequence_number)
{
    for (WatchedSubscription* subscription = find(handle); subscription != nullptr;
         subscription = find(handle)) {
        lose(*subscription, status::Bad_SequenceNumberUnknown);
        if (subscription->sequence.kept_count() == 0) {
            subscription->sequence.restart(sequence_number);
            return;
        }
        while (subscription->sequence.is_missing()) {
            subscription->sequence.skip();
        }
        deliver_kept(handle);
    }
}

void SubscriptionEngine::deliver_kept(SubscriptionHandle handle)
{
    for (WatchedSubscription* subscription = find(handle); subscription != nullptr;
         subscription = find(handle)) {
        const auto message = subscription->sequence.take();
        if (!message) {
            return;
        }
        deliver(*subscription, *message);
    }
}

void SubscriptionEngine::deliver(WatchedSubscription& subscription,
                                 const NotificationMessage& message)
{
    const SubscriptionHandle handle = subscription.handle;
    const std::uint32_t incarnation = subscription.incarnation;
    const std::uint32_t server_id = subscription.server_id;
    report_gap(subscription, message.publish_time);
    StatusCode change;
    for (const ExtensionObject& part : message.notification_data) {
        if (const auto* data = part.get_if<DataChangeNotification>()) {
            deliver_data(handle, *data);
        } else if (const auto* events = part.get_if<EventNotificationList>()) {
            deliver_events(handle, *events);
        } else if (const auto* status = part.get_if<StatusChangeNotification>()) {
            change = status->status;
        } else if (WatchedSubscription* rest = find(handle, incarnation)) {
            lose(*rest, status::Bad_DecodingError); // whatever it was
        }
    }
    WatchedSubscription* rest = find(handle, incarnation);
    if (rest == nullptr) {
        return;
    }
    rest->failures = 0;
    rest->complete_until = message.publish_time;
    acknowledge(server_id, message.sequence_number);
    // Part 4, 7.25.4: ended, be it by its lifetime or because another session has it now.
    if (change.is_bad() || change == status::Good_SubscriptionTransferred) {
        lost(*rest, change, false);
    }
}

void SubscriptionEngine::deliver_data(SubscriptionHandle handle,
                                      const DataChangeNotification& notification)
{
    const WatchedSubscription* subscription = find(handle);
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

void SubscriptionEngine::deliver_events(SubscriptionHandle handle,
                                        const EventNotificationList& notification)
{
    const WatchedSubscription* subscription = find(handle);
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

#include "reception.hpp"

#include <algorithm>

namespace busbar::client::detail {

Reception::Reception(SessionRequests& requests, WatchList& subscriptions, SubscriptionEnds& ends,
                     PublishQueue& publishes, Delivery& delivery)
    : requests_{requests}, subscriptions_{subscriptions}, ends_{ends},
      publishes_{publishes}, delivery_{delivery}
{
}

void Reception::receive(PublishResponse response)
{
    WatchedSubscription* subscription = subscriptions_.find_at_server(response.subscription_id);
    if (subscription == nullptr) {
        // It belongs to an earlier Subscription. One that is being created or transferred may
        // answer before that request does.
        const bool may_become_ours = std::any_of(
            subscriptions_.all().begin(), subscriptions_.all().end(), [](const auto& entry) {
                return entry.second.phase == Phase::Creating ||
                       entry.second.phase == Phase::Transferring;
            });
        if (!may_become_ours) {
            ends_.doom(response.subscription_id);
        }
        return;
    }
    const SubscriptionHandle handle = subscription->handle;
    NotificationMessage message = std::move(response.notification_message);
    if (message.publish_time.is_null()) {
        message.publish_time = response.response_header.timestamp;
    }
    subscription->messages.heard(message.publish_time, requests_.now());
    if (!message.notification_data.empty()) {
        accept_published(handle, std::move(message));
    } else if (!subscription->messages.sequence.expect_before(message.sequence_number)) {
        // Part 4, 5.14.1.1: a keep-alive message has the number of the next message.
        jump_to(handle, message.sequence_number);
    }
    settle(handle);
}

/// A server that counts from elsewhere, as after a restart of its own, would never be heard again:
/// all its messages had numbers of earlier ones.
void Reception::accept_published(SubscriptionHandle handle, NotificationMessage message)
{
    WatchedSubscription& subscription = *subscriptions_.find(handle);
    MessageStream& messages = subscription.messages;
    if (!messages.sequence.has_passed(message.sequence_number)) {
        messages.repeated_count = 0;
    } else if (messages.is_renumbered(message.sequence_number)) {
        messages.repeated_count = 0;
        subscription.lose(status::Bad_SequenceNumberUnknown);
        messages.sequence.restart(message.sequence_number);
    }
    accept(handle, std::move(message));
}

void Reception::accept(SubscriptionHandle handle, NotificationMessage message)
{
    WatchedSubscription& subscription = *subscriptions_.find(handle);
    const std::uint32_t number = message.sequence_number;
    switch (subscription.messages.sequence.put(message)) {
    case SequenceTracker::Arrival::Duplicate:
        // It was delivered earlier; the server may forget it.
        publishes_.acknowledge(subscription.server_id, number);
        break;
    case SequenceTracker::Arrival::TooFar:
        jump_to(handle, number);
        if (WatchedSubscription* rest = subscriptions_.find(handle)) {
            rest->messages.sequence.put(message);
        }
        break;
    case SequenceTracker::Arrival::Kept:
    case SequenceTracker::Arrival::Repeated:
        break;
    }
    deliver_kept(handle);
}

/// Gives up all missing messages before `sequence_number`, and delivers those that are here.
void Reception::jump_to(SubscriptionHandle handle, std::uint32_t sequence_number)
{
    for (WatchedSubscription* subscription = subscriptions_.find(handle); subscription != nullptr;
         subscription = subscriptions_.find(handle)) {
        subscription->lose(status::Bad_SequenceNumberUnknown);
        if (subscription->messages.sequence.kept_count() == 0) {
            subscription->messages.sequence.restart(sequence_number);
            return;
        }
        while (subscription->messages.sequence.is_missing()) {
            subscription->messages.sequence.skip();
        }
        deliver_kept(handle);
    }
}

void Reception::deliver_kept(SubscriptionHandle handle)
{
    for (WatchedSubscription* subscription = subscriptions_.find(handle); subscription != nullptr;
         subscription = subscriptions_.find(handle)) {
        const auto message = subscription->messages.sequence.take();
        if (!message) {
            return;
        }
        delivery_.deliver(*subscription, *message);
    }
}

} // namespace busbar::client::detail

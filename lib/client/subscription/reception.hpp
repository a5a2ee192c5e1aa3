#pragma once

#include <busbar/types/subscription.hpp>

#include "item_table.hpp"
#include "publish_queue.hpp"
#include "session_requests.hpp"
#include "subscription_ends.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// Delivers NotificationMessages in their order to the user's handlers, and acknowledges them.
class Delivery {
public:
    Delivery(WatchList& subscriptions, ItemTable& items, SubscriptionEnds& ends,
             PublishQueue& publishes);

    /// Calls handlers: `subscription` may have been removed by them.
    void deliver(WatchedSubscription& subscription, const NotificationMessage& message);

private:
    void deliver_data(SubscriptionHandle handle, const DataChangeNotification& notification);
    void deliver_events(SubscriptionHandle handle, const EventNotificationList& notification);

    WatchList& subscriptions_;
    ItemTable& items_;
    SubscriptionEnds& ends_;
    PublishQueue& publishes_;
};

/// Sorts the NotificationMessages of each Subscription, fetches missing ones (Part 4, 6.7), and
/// notices if none arrive. The state is each Subscription's MessageStream. All functions may call
/// handlers.
class Reception {
public:
    Reception(SessionRequests& requests, WatchList& subscriptions, SubscriptionEnds& ends,
              PublishQueue& publishes, Delivery& delivery);

    void receive(PublishResponse response);
    /// Requests the messages that the server has kept, before further ones (Part 4, 6.7): an answer
    /// to Publish would push the oldest out.
    void catch_up(WatchedSubscription& subscription);
    /// The server reports that it has no Subscription: Republish tells which exist.
    void probe_all();
    /// Fetches what is due until `now`, and probes if a message is overdue.
    void watch(WatchedSubscription& subscription, TimePoint now);

private:
    void accept_published(SubscriptionHandle handle, NotificationMessage message);
    void accept(SubscriptionHandle handle, NotificationMessage message);
    void jump_to(SubscriptionHandle handle, std::uint32_t sequence_number);
    void deliver_kept(SubscriptionHandle handle);
    void settle(SubscriptionHandle handle);
    void fetch_missing(WatchedSubscription& subscription);
    void republished(WatchedSubscription& subscription, std::uint32_t number, bool is_sent,
                     const Result<RepublishResponse>& response);
    void go_on(SubscriptionHandle handle, std::uint32_t incarnation);
    void not_republished(WatchedSubscription& subscription, bool is_sent, StatusCode status);
    void ask_for_life(WatchedSubscription& subscription);
    /// The message is lost, or does not exist.
    void stop_republishing(WatchedSubscription& subscription, bool is_sent);

    SessionRequests& requests_;
    WatchList& subscriptions_;
    SubscriptionEnds& ends_;
    PublishQueue& publishes_;
    Delivery& delivery_;
};

} // namespace busbar::client::detail

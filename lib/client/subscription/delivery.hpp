#pragma once

#include <busbar/types/subscription.hpp>

#include "item_table.hpp"
#include "publish_queue.hpp"
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

} // namespace busbar::client::detail

#pragma once

#include <busbar/types/subscription.hpp>

#include "delivery.hpp"
#include "publish_queue.hpp"
#include "session_requests.hpp"
#include "subscription_ends.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// Brings the NotificationMessages of each Subscription into their order, fetches those that are
/// missing (Part 4, 6.7), and notices where none come. The state is each Subscription's
/// MessageStream. All of it may call handlers.
class Reception {
public:
    Reception(SessionRequests& requests, WatchList& subscriptions, SubscriptionEnds& ends,
              PublishQueue& publishes, Delivery& delivery);

    void receive(PublishResponse response);
    /// Asks for what the server has kept, before it is asked for more (Part 4, 6.7): an answer to
    /// Publish would push the oldest out.
    void catch_up(WatchedSubscription& subscription);
    /// The server says that it has no Subscription: Republish tells which are there.
    void probe_all();
    /// Fetches what is due until `now`, and probes where something should have come.
    void watch(WatchedSubscription& subscription, TimePoint now);

private:
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
    /// The message is lost, or there is none.
    void stop_republishing(WatchedSubscription& subscription, bool is_sent);

    SessionRequests& requests_;
    WatchList& subscriptions_;
    SubscriptionEnds& ends_;
    PublishQueue& publishes_;
    Delivery& delivery_;
};

} // namespace busbar::client::detail

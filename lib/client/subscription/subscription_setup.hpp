#pragma once

#include <vector>

#include "item_requests.hpp"
#include "item_table.hpp"
#include "polling.hpp"
#include "reception.hpp"
#include "session_requests.hpp"
#include "subscription_ends.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// Creates Subscriptions at the server and changes them (Part 4, 5.14.2 to 5.14.4); has them polled
/// if the server does not know that service set.
class SubscriptionSetup {
public:
    SubscriptionSetup(SessionRequests& requests, WatchList& subscriptions, ItemTable& items,
                      SubscriptionEnds& ends, ItemRequests& changes, ItemPolling& polling);

    void create(WatchedSubscription& subscription);
    void modify(WatchedSubscription& subscription);
    void set_publishing(WatchedSubscription& subscription, bool is_enabled);

private:
    void created(SubscriptionHandle handle, const Result<CreateSubscriptionResponse>& response);
    void creation_failed(WatchedSubscription& subscription, StatusCode status);
    void revise(WatchedSubscription& subscription, const CreateSubscriptionResponse& revised);

    SessionRequests& requests_;
    WatchList& subscriptions_;
    ItemTable& items_;
    SubscriptionEnds& ends_;
    ItemRequests& changes_;
    ItemPolling& polling_;
};

/// Brings Subscriptions at the server into the new session: they continue, are transferred (Part 4,
/// 5.14.7), or are lost.
class SessionChange {
public:
    SessionChange(SessionRequests& requests, WatchList& subscriptions, SubscriptionEnds& ends,
                  Reception& reception);

    /// Calls handlers.
    void begin(bool is_new_session);
    /// Requests transfers that were not requested yet, or were refused for lack of memory and have
    /// waited.
    void transfer();

private:
    void start_again(WatchedSubscription& subscription, bool is_new_session);
    void transferred(const std::vector<SubscriptionHandle>& handles,
                     const Result<TransferSubscriptionsResponse>& response);
    void transferred(WatchedSubscription& subscription, const TransferResult& result);
    void refused(WatchedSubscription& subscription, StatusCode reason);

    SessionRequests& requests_;
    WatchList& subscriptions_;
    SubscriptionEnds& ends_;
    Reception& reception_;
};

} // namespace busbar::client::detail

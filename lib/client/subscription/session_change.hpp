#pragma once

#include <vector>

#include "reception.hpp"
#include "session_requests.hpp"
#include "subscription_ends.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

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

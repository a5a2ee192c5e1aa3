#pragma once

#include <cstdint>
#include <vector>

#include <busbar/client/attributes.hpp>

#include "item_requests.hpp"
#include "item_table.hpp"
#include "session_requests.hpp"
#include "subscription_ends.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// Part 4, 6.7: if notifications are lost for good, ResendData or Read bring the client up to date.
class ValueRefresh {
public:
    ValueRefresh(SessionRequests& requests, WatchList& subscriptions, ItemTable& items,
                 SubscriptionEnds& ends, ItemRequests& item_requests);

    void begin_session() { has_resend_data_ = true; }
    /// Requests values if some were lost and the Gap was reported, so that they follow it.
    void refresh(WatchedSubscription& subscription);

private:
    void ask_again(WatchedSubscription& subscription);
    [[nodiscard]] bool is_stale(const WatchedSubscription& subscription, ItemHandle handle);
    void call_resend_data(WatchedSubscription& subscription);
    void resend_answered(WatchedSubscription& subscription, StatusCode status);
    void queue_stale_items(WatchedSubscription& subscription);
    void read_again(WatchedSubscription& subscription);
    void read_again(WatchedSubscription& subscription, const std::vector<ItemHandle>& items,
                    const std::vector<Result<NodeId>>& nodes, const ReadSettings& settings);
    void deliver_read(SubscriptionHandle handle, const std::vector<DataChange>& values,
                      std::uint32_t losses);

    SessionRequests& requests_;
    WatchList& subscriptions_;
    ItemTable& items_;
    SubscriptionEnds& ends_;
    ItemRequests& item_requests_;
    bool has_resend_data_{true}; // the server, as far as is known
};

} // namespace busbar::client::detail

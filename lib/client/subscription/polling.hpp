#pragma once

#include <cstddef>
#include <vector>

#include "item_poll.hpp"
#include "item_table.hpp"
#include "session_requests.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// Reads items at their sampling interval, if the server has no Subscription service set.
class ItemPolling {
public:
    ItemPolling(SessionRequests& requests, WatchList& subscriptions, ItemTable& items);

    void begin_session();
    /// Assigns the Subscription's items to new places. Calls a handler.
    void start(WatchedSubscription& subscription);
    /// Reads the item from now on, or returns the reason of a failure.
    [[nodiscard]] ItemStatus add(WatchedSubscription& subscription, ItemHandle handle,
                                 const NodeId& node);
    /// Requests the values that are due.
    void poll(WatchedSubscription& subscription, TimePoint now);

private:
    void read(WatchedSubscription& subscription, const PollKey& key);
    void values_read(WatchedSubscription& subscription, const PollKey& key,
                     const std::vector<std::size_t>& places, const Result<ReadResponse>& response);
    /// Keeps the read values; returns those to be delivered.
    [[nodiscard]] std::vector<DataChange> changes_in(PollGroup& group,
                                                     const std::vector<std::size_t>& places,
                                                     const ReadResponse& response);

    SessionRequests& requests_;
    WatchList& subscriptions_;
    ItemTable& items_;
    std::size_t max_batch_; // items of one Read; halved after a Read that was too large
};

} // namespace busbar::client::detail

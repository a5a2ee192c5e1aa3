#pragma once

#include <cstddef>
#include <vector>

#include "item_poll.hpp"
#include "item_table.hpp"
#include "session_requests.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// Reads items where the server has no Subscription service set, at their sampling interval.
class ItemPolling {
public:
    ItemPolling(SessionRequests& requests, WatchList& subscriptions, ItemTable& items);

    void begin_session();
    /// The Subscription's items find their places anew. Calls a handler.
    void start(WatchedSubscription& subscription);
    /// Reads the item from now on, or says why not.
    [[nodiscard]] ItemStatus add(WatchedSubscription& subscription, ItemHandle handle,
                                 const NodeId& node);
    /// Asks for what is due.
    void poll(WatchedSubscription& subscription, TimePoint now);

private:
    void read(WatchedSubscription& subscription, const PollKey& key);
    void values_read(WatchedSubscription& subscription, const PollKey& key,
                     const std::vector<std::size_t>& places, const Result<ReadResponse>& response);
    /// Keeps what was read; those values that are to be delivered.
    [[nodiscard]] std::vector<DataChange> changes_in(PollGroup& group,
                                                     const std::vector<std::size_t>& places,
                                                     const ReadResponse& response);

    SessionRequests& requests_;
    WatchList& subscriptions_;
    ItemTable& items_;
    std::size_t max_batch_; // items of one Read; halved where that was too much
};

} // namespace busbar::client::detail

#pragma once

#include <span>
#include <vector>

#include "item_table.hpp"
#include "session_requests.hpp"
#include "subscription_ends.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// The user's requests, as in busbar/client/subscriptions.hpp. They send nothing and call no
/// handler, but queue work.
class Wishes {
public:
    Wishes(SessionRequests& requests, WatchList& subscriptions, ItemTable& items,
           SubscriptionEnds& ends, const SubscriberLimits& limits);

    Result<SubscriptionHandle> create(const SubscriptionSettings& settings,
                                      SubscriptionHandlers handlers);
    Result<void> modify(SubscriptionHandle handle, const SubscriptionSettings& settings);
    Result<void> remove(SubscriptionHandle handle);
    Result<std::vector<ItemHandle>> add_items(SubscriptionHandle handle,
                                              std::vector<ItemSettings> items);
    Result<void> modify_items(std::span<const ItemHandle> items, const ItemSettings& settings);
    Result<void> remove_items(std::span<const ItemHandle> items);
    Result<void> set_triggering(ItemHandle trigger, std::vector<ItemHandle> links);

private:
    SessionRequests& requests_;
    WatchList& subscriptions_;
    ItemTable& items_;
    SubscriptionEnds& ends_;
    SubscriberLimits limits_;
};

} // namespace busbar::client::detail

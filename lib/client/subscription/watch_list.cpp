#include "watch_list.hpp"

namespace busbar::client::detail {

WatchedSubscription& WatchList::add(const SubscriptionSettings& settings,
                                    SubscriptionHandlers handlers, std::size_t max_missing)
{
    const SubscriptionHandle handle = ++last_handle_;
    return subscriptions_.try_emplace(handle, handle, settings, std::move(handlers), max_missing)
        .first->second;
}

void WatchList::remove(SubscriptionHandle handle)
{
    if (WatchedSubscription* subscription = find(handle)) {
        unname(*subscription);
        subscriptions_.erase(handle);
    }
}

WatchedSubscription* WatchList::find(SubscriptionHandle handle)
{
    const auto found = subscriptions_.find(handle);
    return found == subscriptions_.end() ? nullptr : &found->second;
}

WatchedSubscription* WatchList::find(SubscriptionHandle handle, std::uint32_t incarnation)
{
    WatchedSubscription* subscription = find(handle);
    return subscription != nullptr && subscription->incarnation == incarnation ? subscription
                                                                               : nullptr;
}

WatchedSubscription* WatchList::find_at_server(std::uint32_t server_id)
{
    const auto found = by_server_id_.find(server_id);
    return found == by_server_id_.end() ? nullptr : find(found->second);
}

bool WatchList::name(WatchedSubscription& subscription, std::uint32_t server_id)
{
    if (server_id == 0 || !by_server_id_.emplace(server_id, subscription.handle).second) {
        return false;
    }
    subscription.server_id = server_id;
    return true;
}

void WatchList::unname(WatchedSubscription& subscription)
{
    if (subscription.server_id != 0) {
        by_server_id_.erase(subscription.server_id);
        subscription.server_id = 0;
    }
}

} // namespace busbar::client::detail

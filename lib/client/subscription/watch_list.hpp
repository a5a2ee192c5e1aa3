#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>

#include "watched_subscription.hpp"

namespace busbar::client::detail {

/// The Subscriptions that the user wants, by their handles and by what the server calls them.
///
/// A handler may make and remove whatever it likes: after one was called, a WatchedSubscription has
/// to be looked up again.
class WatchList {
public:
    WatchedSubscription& add(const SubscriptionSettings& settings, SubscriptionHandlers handlers,
                             std::size_t max_missing);
    void remove(SubscriptionHandle handle);
    [[nodiscard]] std::size_t size() const { return subscriptions_.size(); }

    [[nodiscard]] WatchedSubscription* find(SubscriptionHandle handle);
    /// Null as well if it was made anew since: what was asked for then is of no use.
    [[nodiscard]] WatchedSubscription* find(SubscriptionHandle handle, std::uint32_t incarnation);
    [[nodiscard]] WatchedSubscription* find_at_server(std::uint32_t server_id);

    /// The server calls it that. False if that is no name, or another one's.
    bool name(WatchedSubscription& subscription, std::uint32_t server_id);
    /// The server has it no longer.
    void unname(WatchedSubscription& subscription);

    /// `f` may call handlers.
    template <typename F>
    void for_each(F f)
    {
        for (auto next = subscriptions_.begin(); next != subscriptions_.end();) {
            const SubscriptionHandle handle = next->first;
            f(next->second);
            next = subscriptions_.upper_bound(handle);
        }
    }
    [[nodiscard]] const std::map<SubscriptionHandle, WatchedSubscription>& all() const
    {
        return subscriptions_;
    }

private:
    std::map<SubscriptionHandle, WatchedSubscription> subscriptions_;
    std::unordered_map<std::uint32_t, SubscriptionHandle> by_server_id_;
    SubscriptionHandle last_handle_{0};
};

} // namespace busbar::client::detail

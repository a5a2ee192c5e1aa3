#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>

#include "watched_subscription.hpp"

namespace busbar::client::detail {

/// The Subscriptions that the user wants, by their handles and by the server's ids.
///
/// A handler may create and remove any of them: after calling one, a WatchedSubscription must be
/// looked up again.
class WatchList {
public:
    WatchedSubscription& add(const SubscriptionSettings& settings, SubscriptionHandlers handlers,
                             std::size_t max_missing);
    void remove(SubscriptionHandle handle);
    [[nodiscard]] std::size_t size() const { return subscriptions_.size(); }

    [[nodiscard]] WatchedSubscription* find(SubscriptionHandle handle);
    /// Returns null also if it was created again since: the answers to earlier requests are
    /// obsolete.
    [[nodiscard]] WatchedSubscription* find(SubscriptionHandle handle, std::uint32_t incarnation);
    [[nodiscard]] WatchedSubscription* find_at_server(std::uint32_t server_id);

    /// Sets the server's id. False if it is invalid, or belongs to another one.
    bool name(WatchedSubscription& subscription, std::uint32_t server_id);
    /// The server no longer has it.
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

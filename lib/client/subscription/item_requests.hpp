#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "session_requests.hpp"
#include "subscription_ends.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// True if the request may have been carried out although its results are unknown.
[[nodiscard]] bool is_uncertain(StatusCode status);

/// Requests that change a Subscription or its items, one at a time for each Subscription, and the
/// number of items in one.
class ItemRequests {
public:
    /// Number of attempts of a failing request, after which its items get the error.
    static constexpr std::uint32_t max_tries = 3;

    ItemRequests(SessionRequests& requests, WatchList& subscriptions, SubscriptionEnds& ends);

    void begin_session();
    /// The limit of the server, or less if that was too much.
    [[nodiscard]] std::size_t batch_limit() const;
    /// Returns true if `status` means that `count` items were too many, and fewer may succeed.
    bool shrink(StatusCode status, std::size_t count);

    /// Sends a change of `count` items. If it fails, `redo` queues it again, or `done` gets the
    /// error after enough attempts; `done` gets any other answer as well.
    template <typename Response, typename Request, typename Done>
    void change(WatchedSubscription& subscription, Request request, std::size_t count,
                std::function<void(WatchedSubscription&)> redo, Done done);
    /// Passes the NodeIds to `done`: at once, or later if paths must be resolved, unless the
    /// session or the Subscription at the server has changed then.
    void resolve_nodes(const WatchedSubscription& subscription, std::vector<NodeAddress> addresses,
                       std::function<void(const std::vector<Result<NodeId>>&)> done);
    /// Returns a function that is false as soon as answers for the present Subscription are
    /// obsolete. May outlive this.
    [[nodiscard]] std::function<bool()> guard(const WatchedSubscription& subscription) const;

private:
    /// Returns true if a failed change of `count` items must be queued again; no handler was called
    /// then.
    bool change_failed(WatchedSubscription& subscription, StatusCode status, std::size_t count);

    SessionRequests& requests_;
    WatchList& subscriptions_;
    SubscriptionEnds& ends_;
    std::size_t max_batch_;
};

template <typename Response, typename Request, typename Done>
void ItemRequests::change(WatchedSubscription& subscription, Request request, std::size_t count,
                          std::function<void(WatchedSubscription&)> redo, Done done)
{
    subscription.is_busy = true;
    subscription.redo = std::move(redo);
    requests_.send<Response>(
        std::move(request), [this, count, done = std::move(done), handle = subscription.handle,
                             incarnation = subscription.incarnation](const auto& response) {
            WatchedSubscription* changed = subscriptions_.find(handle, incarnation);
            if (changed == nullptr) {
                return;
            }
            changed->is_busy = false;
            const auto again = std::exchange(changed->redo, {});
            changed->failures = response ? 0 : changed->failures;
            if (!response && change_failed(*changed, response.error(), count)) {
                again(*changed);
            } else if (subscriptions_.find(handle, incarnation) != nullptr) {
                done(*changed, response);
            }
        });
}

} // namespace busbar::client::detail

#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "session_requests.hpp"
#include "subscription_ends.hpp"
#include "watch_list.hpp"

namespace busbar::client::detail {

/// The request may have been carried out though nobody knows its results.
[[nodiscard]] bool is_uncertain(StatusCode status);

/// Requests that change a Subscription or its items, one at a time for each Subscription, and how
/// many items one may carry.
class ItemRequests {
public:
    /// A request that keeps failing is tried so often, and its items are told the reason then.
    static constexpr std::uint32_t max_tries = 3;

    ItemRequests(SessionRequests& requests, WatchList& subscriptions, SubscriptionEnds& ends);

    void begin_session();
    /// As the server wants it, or less if that was too much.
    [[nodiscard]] std::size_t batch_limit() const;
    /// True if `status` says that `count` items were too many, and fewer are worth a try.
    bool shrink(StatusCode status, std::size_t count);

    /// Sends a change of `count` items. If it fails, `redo` queues it again, or `done` gets the
    /// error when that has been tried often enough; `done` gets any other answer as well.
    template <typename Response, typename Request, typename Done>
    void change(WatchedSubscription& subscription, Request request, std::size_t count,
                std::function<void(WatchedSubscription&)> redo, Done done);
    /// `done` gets the NodeIds: at once, or later if paths have to be looked up, unless the session
    /// or the Subscription at the server is another one then.
    void resolve_nodes(const WatchedSubscription& subscription, std::vector<NodeAddress> addresses,
                       std::function<void(const std::vector<Result<NodeId>>&)> done);
    /// False as soon as answers for what the Subscription is now are of no use. May outlive this.
    [[nodiscard]] std::function<bool()> guard(const WatchedSubscription& subscription) const;

private:
    /// True if a change of `count` items that failed is to be queued again; no handler was called
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

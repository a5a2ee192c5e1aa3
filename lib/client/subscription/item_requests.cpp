#include "item_requests.hpp"

#include <algorithm>

namespace busbar::client::detail {

namespace {

bool is_too_large(StatusCode status)
{
    return status == status::Bad_TooManyOperations || status == status::Bad_RequestTooLarge ||
           status == status::Bad_ResponseTooLarge || status == status::Bad_EncodingLimitsExceeded;
}

} // namespace

bool is_uncertain(StatusCode status)
{
    return status == status::Bad_Timeout || status == status::Bad_ConnectionClosed ||
           status == status::Bad_SecureChannelClosed || status == status::Bad_DecodingError ||
           status == status::Bad_UnexpectedError || status == status::Bad_RequestInterrupted ||
           status == status::Bad_OutOfMemory;
}

ItemRequests::ItemRequests(SessionRequests& requests, WatchList& subscriptions,
                           SubscriptionEnds& ends)
    : requests_{requests}, subscriptions_{subscriptions}, ends_{ends},
      max_batch_{SessionRequests::default_batch}
{
}

void ItemRequests::begin_session()
{
    max_batch_ = SessionRequests::default_batch;
}

std::size_t ItemRequests::batch_limit() const
{
    const std::size_t allowed = requests_.server().operation_limits.max_monitored_items_per_call;
    return allowed == 0 ? max_batch_ : std::min(allowed, max_batch_);
}

bool ItemRequests::shrink(StatusCode status, std::size_t count)
{
    if (!is_too_large(status) || count <= 1) {
        return false;
    }
    max_batch_ = count / 2;
    return true;
}

bool ItemRequests::change_failed(WatchedSubscription& subscription, StatusCode status,
                                 std::size_t count)
{
    if (status == status::Bad_SubscriptionIdInvalid) {
        ends_.lost(subscription, status, false);
        return false;
    }
    if (shrink(status, count)) {
        return true;
    }
    if (subscription.failures >= max_tries) {
        subscription.failures = 0;
        return false;
    }
    subscription.try_later(requests_.now());
    return true;
}

void ItemRequests::resolve_nodes(const WatchedSubscription& subscription,
                                 std::vector<NodeAddress> addresses,
                                 std::function<void(const std::vector<Result<NodeId>>&)> done)
{
    const bool has_paths =
        std::any_of(addresses.begin(), addresses.end(),
                    [](const NodeAddress& address) { return address.is_path(); });
    if (!has_paths) {
        std::vector<Result<NodeId>> nodes;
        nodes.reserve(addresses.size());
        for (const NodeAddress& address : addresses) {
            nodes.push_back(address.node_id(requests_.server()));
        }
        done(nodes);
        return;
    }
    resolve(requests_.requester(), std::move(addresses),
            [&requests = requests_, guard = guard(subscription),
             done = std::move(done)](const std::vector<Result<NodeId>>& nodes) {
                if (guard()) {
                    requests.watch([&] { done(nodes); });
                }
            });
}

std::function<bool()> ItemRequests::guard(const WatchedSubscription& subscription) const
{
    return [in_session = requests_.in_session(), &subscriptions = subscriptions_,
            handle = subscription.handle, incarnation = subscription.incarnation] {
        return in_session() && subscriptions.find(handle, incarnation) != nullptr;
    };
}

} // namespace busbar::client::detail

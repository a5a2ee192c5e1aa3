#include "subscription_ends.hpp"

#include <algorithm>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::client::detail {

namespace {

constexpr std::size_t max_doomed = 1'000;

} // namespace

SubscriptionEnds::SubscriptionEnds(SessionRequests& requests, WatchList& subscriptions,
                                   PublishQueue& publishes)
    : requests_{requests}, subscriptions_{subscriptions}, publishes_{publishes}
{
}

void SubscriptionEnds::begin_session(bool is_new)
{
    if (is_new) {
        doomed_.clear(); // they belong to another session
    }
}

void SubscriptionEnds::end_session()
{
    // A forgotten one ends with its lifetime.
    busbar::detail::attempt(
        [this] { doomed_.insert(doomed_.end(), deleting_.begin(), deleting_.end()); });
    deleting_.clear();
}

void SubscriptionEnds::remove(WatchedSubscription& subscription)
{
    if (subscription.server_id != 0) {
        publishes_.forget(subscription.server_id);
        doom(subscription.server_id);
    }
    subscriptions_.remove(subscription.handle);
}

void SubscriptionEnds::lost(WatchedSubscription& subscription, StatusCode reason, bool may_live)
{
    publishes_.forget(subscription.server_id);
    if (may_live) {
        doom(subscription.server_id);
    }
    subscriptions_.unname(subscription);
    if (!subscription.messages.complete_until.is_null()) {
        subscription.lose(reason);
    }
    subscription.begin_anew();
    subscription.report_status(reason, {});
}

void SubscriptionEnds::delete_doomed()
{
    if (doomed_.empty() || !deleting_.empty()) {
        return;
    }
    deleting_.swap(doomed_);
    DeleteSubscriptionsRequest request;
    request.subscription_ids = Array<std::uint32_t>{deleting_};
    // One that cannot be deleted ends with its lifetime.
    requests_.send<DeleteSubscriptionsResponse>(request,
                                                [this](const auto&) { deleting_.clear(); });
}

void SubscriptionEnds::doom(std::uint32_t server_id)
{
    if (server_id != 0 && doomed_.size() < max_doomed &&
        std::find(doomed_.begin(), doomed_.end(), server_id) == doomed_.end()) {
        doomed_.push_back(server_id);
    }
}

} // namespace busbar::client::detail

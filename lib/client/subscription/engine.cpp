#include "engine.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::client::detail {

SubscriptionEngine::SubscriptionEngine(Requester& requester, const SubscriberLimits& limits)
    : publishes_{limits.max_publish_requests}, requests_{requester, [this] { work(); }},
      ends_{requests_, subscriptions_, publishes_}, item_requests_{requests_, subscriptions_,
                                                                   ends_},
      polling_{requests_, subscriptions_, items_}, creation_{requests_, subscriptions_, items_,
                                                             ends_,     item_requests_, polling_},
      changes_{items_, item_requests_}, setup_{requests_, subscriptions_, items_,
                                               ends_,     item_requests_, polling_},
      delivery_{subscriptions_, items_, ends_, publishes_}, reception_{requests_, subscriptions_,
                                                                       ends_, publishes_,
                                                                       delivery_},
      publishing_{requests_, subscriptions_, ends_, publishes_, reception_},
      refresh_{requests_, subscriptions_, items_, ends_, item_requests_},
      sessions_{requests_, subscriptions_, ends_, reception_}, wishes_{requests_, subscriptions_,
                                                                       items_, ends_, limits}
{
}

const WatchedSubscription* SubscriptionEngine::find(SubscriptionHandle handle)
{
    return subscriptions_.find(handle);
}

void SubscriptionEngine::session_started(bool is_new)
{
    is_new_session_ = is_new_session_ || is_new;
    requests_.begin_session();
    ends_.begin_session(is_new);
    item_requests_.begin_session();
    polling_.begin_session();
    publishing_.begin_session();
    refresh_.begin_session();
}

/// Calls handlers, so it is part of the next handle_deadline().
void SubscriptionEngine::begin_session()
{
    is_begun_ = true;
    sessions_.begin(std::exchange(is_new_session_, false));
}

void SubscriptionEngine::session_lost()
{
    is_begun_ = false;
    requests_.end_session();
    busbar::detail::attempt([this] {
        requests_.watch([this] {
            publishes_.end_session();
            ends_.end_session();
            subscriptions_.for_each(
                [this](WatchedSubscription& subscription) { subscription.interrupt(items_); });
        });
    });
}

/// Memory ran out, and the state at the server and of the notifications is unknown: everything at
/// the server is created again. This needs hardly any memory itself, and can be repeated.
void SubscriptionEngine::start_over()
{
    requests_.cancel_all();
    publishes_.clear();
    ends_.end_session();
    subscriptions_.for_each([this](WatchedSubscription& subscription) {
        subscription.polls.clear();
        ends_.lost(subscription, status::Bad_OutOfMemory, true);
    });
    requests_.forget_failure();
}

TimePoint SubscriptionEngine::next_deadline() const
{
    if (!requests_.has_session()) {
        return no_deadline;
    }
    if (requests_.has_work() || requests_.has_failed() || !is_begun_) {
        return requests_.now();
    }
    TimePoint next = publishing_.next_deadline(handled_until_);
    for (const auto& [handle, subscription] : subscriptions_.all()) {
        next = std::min(next, subscription.next_deadline(handled_until_));
    }
    return next;
}

void SubscriptionEngine::handle_deadline(TimePoint now)
{
    if (!requests_.has_session()) {
        return;
    }
    handled_until_ = now;
    if (requests_.has_failed()) {
        start_over();
    }
    requests_.watch([&] { do_all(now); });
}

void SubscriptionEngine::do_all(TimePoint now)
{
    if (!is_begun_) {
        begin_session();
    }
    work();
    subscriptions_.for_each([&](WatchedSubscription& subscription) {
        const SubscriptionHandle handle = subscription.handle;
        reception_.watch(subscription, now);
        if (WatchedSubscription* rest = subscriptions_.find(handle)) {
            polling_.poll(*rest, now);
        }
    });
    publishing_.publish();
}

void SubscriptionEngine::work()
{
    requests_.begin_work();
    if (!requests_.has_session() || !is_begun_) {
        return;
    }
    subscriptions_.for_each([this](WatchedSubscription& subscription) { work_on(subscription); });
    subscriptions_.for_each(
        [this](WatchedSubscription& subscription) { refresh_.refresh(subscription); });
    ends_.delete_doomed();
    publishing_.publish();
}

void SubscriptionEngine::work_on(WatchedSubscription& subscription)
{
    if (!requests_.has_session() || subscription.is_busy ||
        requests_.now() < subscription.retry_at) {
        return;
    }
    switch (subscription.phase) {
    case Phase::Wished:
        setup_.create(subscription);
        break;
    case Phase::Live:
        work_on_live(subscription);
        break;
    case Phase::Polling:
        creation_.create(subscription);
        break;
    case Phase::Transferring:
        sessions_.transfer();
        break;
    case Phase::Creating:
        break;
    }
}

void SubscriptionEngine::work_on_live(WatchedSubscription& subscription)
{
    const bool is_enabled = subscription.settings.is_publishing_enabled;
    if (subscription.is_modified) {
        setup_.modify(subscription);
    } else if (!is_enabled && subscription.is_publishing) {
        setup_.set_publishing(subscription, false);
    } else if (changes_.remove(subscription) || creation_.create(subscription) ||
               changes_.send_one(subscription)) {
        return; // one at a time
    } else if (is_enabled && !subscription.is_publishing) {
        setup_.set_publishing(subscription, true);
    }
}

} // namespace busbar::client::detail

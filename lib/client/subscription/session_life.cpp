#include <algorithm>

#include "engine.hpp"

namespace busbar::client::detail {

SubscriptionEngine::SubscriptionEngine(Requester& requester, const SubscriberLimits& limits)
    : requester_{requester}, limits_{limits}, self_{std::make_shared<SubscriptionEngine*>(this)},
      max_publishes_{std::max<std::size_t>(limits.max_publish_requests, 1)},
      max_batch_{ItemTable::capacity}
{
}

SubscriptionEngine::~SubscriptionEngine()
{
    cancel_all();
}

void SubscriptionEngine::cancel(std::uint64_t token)
{
    const auto found = requests_.find(token);
    if (found != requests_.end()) {
        requester_.cancel(found->second);
        requests_.erase(found);
    }
}

void SubscriptionEngine::cancel_all()
{
    for (const auto& [token, request] : std::exchange(requests_, {})) {
        requester_.cancel(request);
    }
}

void SubscriptionEngine::session_started(bool is_new)
{
    has_session_ = true;
    has_work_ = true;
    is_new_session_ = is_new_session_ || is_new;
    max_publishes_ = std::max<std::size_t>(limits_.max_publish_requests, 1);
    max_batch_ = ItemTable::capacity;
    publish_at_ = {};
    has_resend_data_ = true;
    if (is_new) {
        doomed_.clear(); // of another session
    }
}

/// Its handlers are called, so it is part of the next handle_deadline().
void SubscriptionEngine::begin_session()
{
    is_begun_ = true;
    const bool is_new = std::exchange(is_new_session_, false);
    for_each([&](WatchedSubscription& subscription) { start_again(subscription, is_new); });
    transfer();
}

void SubscriptionEngine::start_again(WatchedSubscription& subscription, bool is_new_session)
{
    subscription.retry_at = {};
    subscription.republish_at = {};
    subscription.probe_count = 0;
    subscription.is_catching_up = false;
    const bool is_at_server = subscription.server_id != 0;
    if (is_at_server && subscription.is_uncertain) {
        lost(subscription, status::Bad_SubscriptionIdInvalid, true);
    } else if (is_at_server && (is_new_session || subscription.phase == Phase::Transferring)) {
        subscription.phase = Phase::Transferring;
    } else if (is_at_server) {
        catch_up(subscription);
    } else if (subscription.phase == Phase::Polling) {
        subscription.polls.clear();
        subscription.phase = Phase::Wished; // this one may have Subscriptions
        if (!subscription.complete_until.is_null()) {
            lose(subscription, status::Bad_NoSubscription);
        }
    }
}

void SubscriptionEngine::session_lost()
{
    has_session_ = false;
    is_begun_ = false;
    ++epoch_;
    cancel_all();
    for (auto& [token, entry] : std::exchange(publishes_, {})) {
        take_back(std::move(entry.acknowledgements));
    }
    doomed_.insert(doomed_.end(), deleting_.begin(), deleting_.end());
    deleting_.clear();
    for (auto& [handle, subscription] : subscriptions_) {
        interrupt(subscription);
    }
}

/// The requests under way have no answers. Changes of items are made again, they are the same
/// twice.
void SubscriptionEngine::interrupt(WatchedSubscription& subscription)
{
    subscription.is_republishing = false;
    subscription.silent_at = no_deadline;
    subscription.refresh.interrupt();
    if (subscription.phase == Phase::Creating) {
        subscription.phase = Phase::Wished;
    }
    for (auto& [key, group] : subscription.polls) {
        group.is_reading = false;
    }
    if (!std::exchange(subscription.is_busy, false)) {
        return;
    }
    for (const ItemHandle handle : std::exchange(subscription.under_way, {})) {
        queue_creation(subscription, handle);
    }
    if (subscription.redo) {
        std::exchange(subscription.redo, {})(subscription);
    }
}

void SubscriptionEngine::transfer()
{
    std::vector<SubscriptionHandle> handles;
    // Values that were delivered must not come again; what is missing comes by Republish.
    TransferSubscriptionsRequest request;
    request.send_initial_values = false;
    for (const auto& [handle, subscription] : subscriptions_) {
        if (subscription.phase == Phase::Transferring) {
            handles.push_back(handle);
            request.subscription_ids.push_back(subscription.server_id);
        }
    }
    if (handles.empty()) {
        return;
    }
    send<TransferSubscriptionsResponse>(std::move(request),
                                        [this, handles = std::move(handles)](const auto& response) {
                                            transferred(handles, response);
                                        });
}

void SubscriptionEngine::transferred(const std::vector<SubscriptionHandle>& handles,
                                     const Result<TransferSubscriptionsResponse>& response)
{
    if (!response && response.error() == status::Bad_Timeout) {
        transfer();
        return;
    }
    if (!response && (response.error() == status::Bad_ConnectionClosed ||
                      response.error() == status::Bad_SecureChannelClosed)) {
        return; // the next session tries it
    }
    for (std::size_t i = 0; i < handles.size(); ++i) {
        WatchedSubscription* subscription = find(handles[i]);
        if (subscription == nullptr || subscription->phase != Phase::Transferring) {
            continue;
        }
        if (!response) {
            lost(*subscription, response.error(), true);
        } else if (i >= response->results.size() || response->results[i].status_code.is_bad()) {
            lost(*subscription,
                 i < response->results.size() ? response->results[i].status_code
                                              : StatusCode{status::Bad_UnexpectedError},
                 true);
        } else {
            transferred(*subscription, response->results[i]);
        }
    }
}

void SubscriptionEngine::transferred(WatchedSubscription& subscription,
                                     const TransferResult& result)
{
    subscription.phase = Phase::Live;
    // Numbers that are too far ahead are not believed until a message has one.
    for (const std::uint32_t number : result.available_sequence_numbers) {
        subscription.sequence.expect_through(number);
    }
    catch_up(subscription);
}

/// Asks for what the server has kept, before it is asked for more (Part 4, 6.7): an answer to
/// Publish would push the oldest out.
void SubscriptionEngine::catch_up(WatchedSubscription& subscription)
{
    subscription.is_probing = true;
    subscription.is_catching_up = true;
    heard(subscription, subscription.heard_time);
    fetch_missing(subscription);
}

TimePoint SubscriptionEngine::next_deadline() const
{
    if (!has_session_) {
        return no_deadline;
    }
    if (has_work_ || !is_begun_) {
        return requester_.now();
    }
    TimePoint next = publish_at_ > handled_until_ ? publish_at_ : no_deadline;
    for (const auto& [handle, subscription] : subscriptions_) {
        next = std::min(next, deadline_of(subscription));
    }
    return next;
}

TimePoint SubscriptionEngine::deadline_of(const WatchedSubscription& subscription) const
{
    TimePoint next = subscription.phase == Phase::Live ? subscription.silent_at : no_deadline;
    if (!subscription.is_busy && subscription.retry_at > handled_until_) {
        next = std::min(next, subscription.retry_at);
    }
    if (!subscription.is_republishing && subscription.republish_at > handled_until_) {
        next = std::min(next, subscription.republish_at);
    }
    if (subscription.refresh.at > handled_until_ &&
        (subscription.refresh.is_due || subscription.refresh.is_reading())) {
        next = std::min(next, subscription.refresh.at);
    }
    for (const auto& [key, group] : subscription.polls) {
        next = group.is_reading ? next : std::min(next, group.due);
    }
    return next;
}

void SubscriptionEngine::handle_deadline(TimePoint now)
{
    if (!has_session_) {
        return;
    }
    handled_until_ = now;
    if (!is_begun_) {
        begin_session();
    }
    work();
    for_each([&](WatchedSubscription& subscription) {
        watch(subscription, now);
        poll(subscription, now);
    });
    publish();
}

} // namespace busbar::client::detail

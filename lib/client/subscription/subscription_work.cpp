#include <algorithm>
#include <cmath>

#include "engine.hpp"

namespace busbar::client::detail {

namespace {

using std::chrono::milliseconds;
using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr Duration longest_keep_alive = std::chrono::hours{24};
constexpr Duration first_retry = std::chrono::seconds{1};
constexpr std::uint32_t most_doublings = 5; // 32 s
constexpr std::size_t max_doomed = 1'000;

/// What the server revised, or what was asked for if that makes no sense.
double sensible(double revised, double asked)
{
    if (std::isfinite(revised) && revised > 0) {
        return revised;
    }
    return std::isfinite(asked) && asked > 0 ? asked : 1'000;
}

Duration keep_alive_interval(double interval_ms, std::uint32_t count)
{
    const Milliseconds interval{interval_ms * std::max<std::uint32_t>(count, 1)};
    if (!(interval < longest_keep_alive)) {
        return longest_keep_alive;
    }
    return std::max<Duration>(std::chrono::duration_cast<Duration>(interval), milliseconds{10});
}

} // namespace

void SubscriptionEngine::work()
{
    has_work_ = false;
    if (!has_session_ || !is_begun_) {
        return;
    }
    for_each([this](WatchedSubscription& subscription) { work_on(subscription); });
    for_each([this](WatchedSubscription& subscription) { refresh(subscription); });
    delete_doomed();
    publish();
}

void SubscriptionEngine::work_on(WatchedSubscription& subscription)
{
    if (!has_session_ || subscription.is_busy || requester_.now() < subscription.retry_at) {
        return;
    }
    switch (subscription.phase) {
    case Phase::Wished:
        create_at_server(subscription);
        break;
    case Phase::Live:
        work_on_live(subscription);
        break;
    case Phase::Polling:
        create_items(subscription);
        break;
    case Phase::Creating:
    case Phase::Transferring:
        break;
    }
}

void SubscriptionEngine::work_on_live(WatchedSubscription& subscription)
{
    const bool is_enabled = subscription.settings.is_publishing_enabled;
    if (subscription.is_modified) {
        modify_at_server(subscription);
    } else if (!is_enabled && subscription.is_publishing) {
        set_publishing(subscription, false);
    } else if (delete_items(subscription) || create_items(subscription) ||
               modify_items(subscription) || set_modes(subscription) || link_items(subscription)) {
        return; // one at a time
    } else if (is_enabled && !subscription.is_publishing) {
        set_publishing(subscription, true);
    }
}

void SubscriptionEngine::create_at_server(WatchedSubscription& subscription)
{
    const SubscriptionSettings& settings = subscription.settings;
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = settings.publishing_interval.count();
    // Part 4, 5.14.2.2: at least three times the keep-alive count.
    const std::uint64_t least = std::uint64_t{settings.max_keep_alive_count} * 3;
    request.requested_lifetime_count = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(std::max<std::uint64_t>(settings.lifetime_count, least), ~0U));
    request.requested_max_keep_alive_count = settings.max_keep_alive_count;
    request.max_notifications_per_publish = settings.max_notifications_per_publish;
    request.priority = settings.priority;
    // One that replaces another begins when all its items are there: the Gap ends then for all.
    request.publishing_enabled = settings.is_publishing_enabled && !subscription.loss;
    subscription.phase = Phase::Creating;
    subscription.is_busy = true;
    subscription.is_modified = false;
    subscription.is_publishing = request.publishing_enabled;
    subscription.created_at = requester_.now();
    send<CreateSubscriptionResponse>(
        request, [this, handle = subscription.handle](const auto& r) { created(handle, r); });
}

void SubscriptionEngine::created(SubscriptionHandle handle,
                                 const Result<CreateSubscriptionResponse>& response)
{
    WatchedSubscription* subscription = find(handle);
    if (subscription == nullptr) {
        if (response) {
            doom(response->subscription_id);
        }
        return;
    }
    subscription->is_busy = false;
    subscription->phase = Phase::Wished;
    if (!response) {
        creation_failed(*subscription, response.error());
        return;
    }
    const std::uint32_t id = response->subscription_id;
    if (id == 0 || !by_server_id_.emplace(id, handle).second) {
        creation_failed(*subscription, status::Bad_SubscriptionIdInvalid);
        return;
    }
    subscription->phase = Phase::Live;
    subscription->server_id = id;
    subscription->failures = 0;
    revise(*subscription, *response);
    queue_all_items(*subscription);
    report_status(*subscription, status::Good, *response);
}

void SubscriptionEngine::creation_failed(WatchedSubscription& subscription, StatusCode status)
{
    if (status == status::Bad_ServiceUnsupported || status == status::Bad_NotImplemented) {
        start_polling(subscription);
        return;
    }
    try_later(subscription);
    report_status(subscription, status, {});
}

void SubscriptionEngine::revise(WatchedSubscription& subscription,
                                const CreateSubscriptionResponse& revised)
{
    const double interval = sensible(revised.revised_publishing_interval,
                                     subscription.settings.publishing_interval.count());
    const std::uint32_t count = revised.revised_max_keep_alive_count != 0
                                    ? revised.revised_max_keep_alive_count
                                    : subscription.settings.max_keep_alive_count;
    subscription.keep_alive_interval = keep_alive_interval(interval, count);
    heard(subscription, subscription.heard_time);
}

void SubscriptionEngine::modify_at_server(WatchedSubscription& subscription)
{
    const SubscriptionSettings& settings = subscription.settings;
    ModifySubscriptionRequest request;
    request.subscription_id = subscription.server_id;
    request.requested_publishing_interval = settings.publishing_interval.count();
    request.requested_lifetime_count = settings.lifetime_count;
    request.requested_max_keep_alive_count = settings.max_keep_alive_count;
    request.max_notifications_per_publish = settings.max_notifications_per_publish;
    request.priority = settings.priority;
    subscription.is_modified = false;
    change<ModifySubscriptionResponse>(
        subscription, request, 1, [](WatchedSubscription& changed) { changed.is_modified = true; },
        [this](WatchedSubscription& changed, const auto& response) {
            if (!response) {
                report_status(changed, response.error(), {});
                return;
            }
            CreateSubscriptionResponse revised;
            revised.response_header = response->response_header;
            revised.subscription_id = changed.server_id;
            revised.revised_publishing_interval = response->revised_publishing_interval;
            revised.revised_lifetime_count = response->revised_lifetime_count;
            revised.revised_max_keep_alive_count = response->revised_max_keep_alive_count;
            revise(changed, revised);
            report_status(changed, status::Good, revised);
        });
}

void SubscriptionEngine::set_publishing(WatchedSubscription& subscription, bool is_enabled)
{
    SetPublishingModeRequest request;
    request.publishing_enabled = is_enabled;
    request.subscription_ids = {subscription.server_id};
    subscription.is_publishing = is_enabled;
    change<SetPublishingModeResponse>(
        subscription, request, 1,
        [is_enabled](WatchedSubscription& changed) { changed.is_publishing = !is_enabled; },
        [this](WatchedSubscription& changed, const auto& response) {
            const bool has_result = response && response->results.size() == 1;
            const StatusCode status = !response    ? response.error()
                                      : has_result ? response->results[0]
                                                   : StatusCode{status::Bad_UnexpectedError};
            if (status.is_bad()) {
                report_status(changed, status, {});
            }
        });
}

void SubscriptionEngine::delete_doomed()
{
    if (doomed_.empty() || !deleting_.empty()) {
        return;
    }
    deleting_.swap(doomed_);
    DeleteSubscriptionsRequest request;
    request.subscription_ids = Array<std::uint32_t>{deleting_};
    // One that cannot be deleted ends with its lifetime.
    send<DeleteSubscriptionsResponse>(request, [this](const auto&) { deleting_.clear(); });
}

void SubscriptionEngine::doom(std::uint32_t server_id)
{
    if (server_id != 0 && doomed_.size() < max_doomed &&
        std::find(doomed_.begin(), doomed_.end(), server_id) == doomed_.end()) {
        doomed_.push_back(server_id);
    }
}

void SubscriptionEngine::lost(WatchedSubscription& subscription, StatusCode reason, bool may_live)
{
    by_server_id_.erase(subscription.server_id);
    forget_acknowledgements(subscription.server_id);
    if (may_live) {
        doom(subscription.server_id);
    }
    if (!subscription.complete_until.is_null()) {
        lose(subscription, reason);
    }
    ++subscription.incarnation;
    subscription.server_id = 0;
    subscription.phase = Phase::Wished;
    subscription.is_busy = false;
    subscription.is_uncertain = false;
    subscription.is_republishing = false;
    subscription.is_probing = false;
    subscription.republish_failures = 0;
    subscription.refresh.interrupt();
    subscription.under_way.clear();
    subscription.redo = {};
    subscription.silent_at = no_deadline;
    subscription.heard_time = {};
    subscription.sequence = SequenceTracker{limits_.max_missing};
    // However often a server takes it away, it is not asked more than once a second.
    subscription.retry_at = subscription.created_at + first_retry;
    report_status(subscription, reason, {});
}

void SubscriptionEngine::report_status(WatchedSubscription& subscription, StatusCode status,
                                       const CreateSubscriptionResponse& response)
{
    const auto handlers = subscription.handlers;
    if (handlers->on_status) {
        handlers->on_status(status, subscription.mode(), response);
    }
}

void SubscriptionEngine::try_later(WatchedSubscription& subscription)
{
    const auto doublings = std::min(subscription.failures++, most_doublings);
    subscription.retry_at = requester_.now() + first_retry * (1U << doublings);
}

} // namespace busbar::client::detail

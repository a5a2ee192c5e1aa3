#include <algorithm>
#include <cmath>

#include "subscription_setup.hpp"

namespace busbar::client::detail {

namespace {

using std::chrono::milliseconds;
using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr Duration longest_keep_alive = std::chrono::hours{24};

/// Returns the server's revised value, or the requested one if that is absurd.
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

SubscriptionSetup::SubscriptionSetup(SessionRequests& requests, WatchList& subscriptions,
                                     ItemTable& items, SubscriptionEnds& ends,
                                     ItemRequests& changes, ItemPolling& polling)
    : requests_{requests}, subscriptions_{subscriptions}, items_{items}, ends_{ends},
      changes_{changes}, polling_{polling}
{
}

void SubscriptionSetup::create(WatchedSubscription& subscription)
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
    // A replacement is enabled when all its items exist: the Gap then ends for all.
    request.publishing_enabled = settings.is_publishing_enabled && !subscription.messages.loss;
    subscription.phase = Phase::Creating;
    subscription.is_busy = true;
    subscription.is_modified = false;
    subscription.is_publishing = request.publishing_enabled;
    subscription.created_at = requests_.now();
    requests_.send<CreateSubscriptionResponse>(
        request, [this, handle = subscription.handle](const auto& r) { created(handle, r); });
}

void SubscriptionSetup::created(SubscriptionHandle handle,
                                const Result<CreateSubscriptionResponse>& response)
{
    WatchedSubscription* subscription = subscriptions_.find(handle);
    if (subscription == nullptr) {
        if (response) {
            ends_.doom(response->subscription_id);
        }
        return;
    }
    subscription->is_busy = false;
    subscription->phase = Phase::Wished;
    if (!response) {
        creation_failed(*subscription, response.error());
        return;
    }
    if (!subscriptions_.name(*subscription, response->subscription_id)) {
        creation_failed(*subscription, status::Bad_SubscriptionIdInvalid);
        return;
    }
    subscription->phase = Phase::Live;
    subscription->failures = 0;
    revise(*subscription, *response);
    subscription->queue_all_items(items_);
    subscription->report_status(status::Good, *response);
}

void SubscriptionSetup::creation_failed(WatchedSubscription& subscription, StatusCode status)
{
    if (status == status::Bad_ServiceUnsupported || status == status::Bad_NotImplemented) {
        polling_.start(subscription);
        return;
    }
    subscription.try_later(requests_.now());
    subscription.report_status(status, {});
}

void SubscriptionSetup::revise(WatchedSubscription& subscription,
                               const CreateSubscriptionResponse& revised)
{
    const double interval = sensible(revised.revised_publishing_interval,
                                     subscription.settings.publishing_interval.count());
    const std::uint32_t count = revised.revised_max_keep_alive_count != 0
                                    ? revised.revised_max_keep_alive_count
                                    : subscription.settings.max_keep_alive_count;
    const Duration revised_time = keep_alive_interval(interval, count);
    // A server that says nothing for a day, unasked, would not be missed if it were gone.
    subscription.messages.keep_alive_interval =
        revised_time < longest_keep_alive
            ? revised_time
            : keep_alive_interval(
                  sensible(subscription.settings.publishing_interval.count(), 1'000),
                  subscription.settings.max_keep_alive_count);
    subscription.messages.heard(subscription.messages.heard_time, requests_.now());
}

void SubscriptionSetup::modify(WatchedSubscription& subscription)
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
    changes_.change<ModifySubscriptionResponse>(
        subscription, request, 1, [](WatchedSubscription& changed) { changed.is_modified = true; },
        [this](WatchedSubscription& changed, const auto& response) {
            if (!response) {
                changed.report_status(response.error(), {});
                return;
            }
            CreateSubscriptionResponse revised;
            revised.response_header = response->response_header;
            revised.subscription_id = changed.server_id;
            revised.revised_publishing_interval = response->revised_publishing_interval;
            revised.revised_lifetime_count = response->revised_lifetime_count;
            revised.revised_max_keep_alive_count = response->revised_max_keep_alive_count;
            revise(changed, revised);
            changed.report_status(status::Good, revised);
        });
}

void SubscriptionSetup::set_publishing(WatchedSubscription& subscription, bool is_enabled)
{
    SetPublishingModeRequest request;
    request.publishing_enabled = is_enabled;
    request.subscription_ids = {subscription.server_id};
    subscription.is_publishing = is_enabled;
    changes_.change<SetPublishingModeResponse>(
        subscription, request, 1,
        [is_enabled](WatchedSubscription& changed) { changed.is_publishing = !is_enabled; },
        [](WatchedSubscription& changed, const auto& response) {
            const bool has_result = response && response->results.size() == 1;
            const StatusCode status = !response    ? response.error()
                                      : has_result ? response->results[0]
                                                   : StatusCode{status::Bad_UnexpectedError};
            if (status.is_bad()) {
                changed.report_status(status, {});
            }
        });
}

} // namespace busbar::client::detail

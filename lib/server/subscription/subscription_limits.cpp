#include <busbar/server/subscription_limits.hpp>

#include <algorithm>
#include <cmath>

namespace busbar::server {

namespace {

using std::chrono::milliseconds;

milliseconds nearest(const std::vector<milliseconds>& intervals, double requested)
{
    const auto distance = [requested](milliseconds interval) {
        return std::abs(static_cast<double>(interval.count()) - requested);
    };
    // The first of equals, which is the shorter.
    return *std::min_element(
        intervals.begin(), intervals.end(),
        [&](milliseconds a, milliseconds b) { return distance(a) < distance(b); });
}

/// Whole microseconds: finer than a clock keeps, and equal intervals share one batch.
Duration to_duration(double interval_ms)
{
    return std::chrono::microseconds{static_cast<std::int64_t>(std::ceil(interval_ms * 1'000))};
}

/// Returns the first step that is long enough; past all steps the minimum itself.
Duration not_shorter(const std::vector<milliseconds>& intervals, double minimum)
{
    const auto found =
        std::find_if(intervals.begin(), intervals.end(), [minimum](milliseconds interval) {
            return static_cast<double>(interval.count()) >= minimum;
        });
    return found != intervals.end() ? Duration{*found} : to_duration(minimum);
}

} // namespace

Duration SamplingPolicy::revise(double requested_milliseconds, Duration publishing_interval,
                                bool can_follow_scans, double minimum_sampling_interval) const
{
    if (requested_milliseconds == 0 && can_follow_scans && samples_each_scan) {
        return Duration::zero();
    }
    // Also true for NaN.
    const bool is_default = !(requested_milliseconds >= 0);
    const double requested =
        is_default ? to_milliseconds(publishing_interval) : requested_milliseconds;
    // A year is practically for ever, and clocks can count it. The minimum may be NaN, too.
    constexpr double longest = 365.0 * 86'400'000;
    const double minimum =
        minimum_sampling_interval > 0 ? std::min(minimum_sampling_interval, longest) : 0;
    if (!intervals.empty()) {
        const milliseconds step =
            nearest(intervals, std::min(requested, to_milliseconds(intervals.back())));
        return to_milliseconds(step) >= minimum ? step : not_shorter(intervals, minimum);
    }
    const double clamped = std::clamp(requested, static_cast<double>(min_interval.count()),
                                      static_cast<double>(max_interval.count()));
    return to_duration(std::max(clamped, minimum));
}

SamplingPolicy stepped_sampling()
{
    SamplingPolicy policy;
    policy.min_interval = milliseconds{200};
    policy.max_interval = milliseconds{60'000};
    for (const int step : {100, 1'000, 10'000}) {
        for (int i = step == 100 ? 2 : 1; i <= (step == 10'000 ? 6 : 9); ++i) {
            policy.intervals.emplace_back(i * step);
        }
    }
    policy.samples_each_scan = false;
    policy.overload_percent = 5;
    return policy;
}

SubscriptionLimits rd81opc96_subscriptions()
{
    SubscriptionLimits limits;
    limits.max_subscriptions_per_session = 10;
    limits.max_subscriptions_per_user = 150;
    limits.max_subscriptions = 150;
    limits.max_items_per_subscription = 15'000;
    limits.max_items_per_user = 15'000;
    limits.max_items = 15'000;
    limits.min_publishing_interval = milliseconds{50};
    limits.min_keep_alive = milliseconds{5'000};
    limits.min_lifetime = milliseconds{10'000};
    limits.max_queue_size = 10;
    limits.max_event_queue_size = 10;
    limits.sampling = stepped_sampling();
    return limits;
}

SubscriptionLimits nj501_subscriptions()
{
    SubscriptionLimits limits;
    limits.max_subscriptions_per_user = 100;
    limits.max_subscriptions = 100;
    limits.max_items_per_subscription = 2'000;
    limits.max_items_per_user = 2'000;
    limits.max_items = 2'000;
    return limits;
}

SubscriptionLimits nx102_subscriptions()
{
    return nj501_subscriptions();
}

} // namespace busbar::server

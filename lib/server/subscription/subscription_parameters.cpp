#include <algorithm>
#include <cmath>

#include "subscription.hpp"

namespace busbar::server::detail {

namespace {

/// Returns how many intervals are at least this time, limited so that no counter overflows.
std::uint32_t intervals_in(std::chrono::milliseconds time, Duration interval)
{
    const std::int64_t count = (Duration{time}.count() + interval.count() - 1) / interval.count();
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(count, 1, UINT32_MAX / 4));
}

Duration revise_interval(const SubscriptionLimits& limits, double milliseconds)
{
    const auto count = [](std::chrono::milliseconds time) {
        return static_cast<double>(time.count());
    };
    // Also used for NaN and values that are not positive.
    double revised = count(limits.min_publishing_interval);
    if (milliseconds > revised) {
        revised = std::min(milliseconds, count(limits.max_publishing_interval));
    }
    return std::chrono::microseconds{static_cast<std::int64_t>(std::ceil(revised * 1'000))};
}

} // namespace

SubscriptionParameters revise(const SubscriptionLimits& limits, double publishing_interval,
                              std::uint32_t lifetime_count, std::uint32_t max_keep_alive_count,
                              std::uint32_t max_notifications_per_publish, std::uint8_t priority)
{
    SubscriptionParameters revised;
    const Duration interval = revise_interval(limits, publishing_interval);
    revised.publishing_interval = interval;
    const std::uint32_t most_keep_alive = intervals_in(limits.max_keep_alive, interval);
    const std::uint32_t least_keep_alive =
        std::min(intervals_in(limits.min_keep_alive, interval), most_keep_alive);
    revised.max_keep_alive_count =
        std::clamp(max_keep_alive_count, least_keep_alive, most_keep_alive);
    // At least three times the keep-alive count (Part 4, 5.14.2.2), which is at most UINT32_MAX
    // / 4.
    const std::uint32_t least =
        std::max(intervals_in(limits.min_lifetime, interval), 3 * revised.max_keep_alive_count);
    const std::uint32_t most = std::max(intervals_in(limits.max_lifetime, interval), least);
    revised.lifetime_count = std::clamp(lifetime_count, least, most);
    revised.max_notifications_per_publish =
        max_notifications_per_publish == 0
            ? limits.max_notifications_per_publish
            : std::min(max_notifications_per_publish, limits.max_notifications_per_publish);
    revised.priority = priority;
    return revised;
}

} // namespace busbar::server::detail

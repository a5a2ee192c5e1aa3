#include "channel_guard.hpp"

#include <algorithm>
#include <utility>

#include "server/users/login_guard.hpp"

namespace busbar::server::detail {

namespace {

/// Renewals that one channel may request at once, and within the shortest lifetime of a token.
constexpr int renewals_per_lifetime = 4;

} // namespace

Duration TokenBucket::wait(std::size_t burst, Duration interval, TimePoint now) const
{
    if (interval <= Duration::zero() || spent_until <= now) {
        return Duration::zero();
    }
    const Duration ahead = spent_until - now;
    if (static_cast<std::size_t>(ahead / interval) < burst - 1) {
        return Duration::zero();
    }
    return ahead - interval * static_cast<Duration::rep>(burst - 1);
}

void TokenBucket::spend(Duration interval, TimePoint now)
{
    spent_until = std::max(spent_until, now) + interval;
}

ChannelGuard::Source* ChannelGuard::find(std::string_view name)
{
    const auto found = std::find_if(sources_.begin(), sources_.end(),
                                    [&](const Source& source) { return source.name == name; });
    return found == sources_.end() ? nullptr : &*found;
}

ChannelGuard::Source& ChannelGuard::find_or_add(std::string_view name, TimePoint now)
{
    Source* source = find(name);
    if (source == nullptr) {
        if (sources_.size() >= limits_->max_channel_entries) {
            sources_.erase(
                std::min_element(sources_.begin(), sources_.end(),
                                 [](const Source& a, const Source& b) { return a.seen < b.seen; }));
        }
        source = &sources_.emplace_back();
        source->name = name;
    }
    source->seen = now;
    return *source;
}

void ChannelGuard::forgive_in_time(Source& source, TimePoint now) const
{
    const Duration interval = limits_->failed_channel_interval;
    if (source.failures == 0 || interval <= Duration::zero()) {
        source.failures = 0;
        return;
    }
    const auto passed = std::max<Duration::rep>((now - source.counted) / interval, 0);
    if (static_cast<std::uint64_t>(passed) >= source.failures) {
        source.failures = 0;
        return;
    }
    source.failures -= static_cast<std::size_t>(passed);
    source.counted += interval * passed;
}

bool ChannelGuard::is_failing(const Source& source) const
{
    return source.failures >= limits_->max_channel_failures;
}

ChannelGuard::Admission ChannelGuard::admit(std::string_view name, Duration longest, TimePoint now)
{
    Source& source = find_or_add(name, now);
    forgive_in_time(source, now);
    Admission admission;
    if (is_failing(source)) {
        admission.cost = limits_->failed_channel_interval;
        admission.wait = source.bucket.wait(1, admission.cost, now);
    } else {
        admission.cost = limits_->channel_interval;
        admission.wait = source.bucket.wait(limits_->max_channel_burst, admission.cost, now);
    }
    if (admission.wait > std::min<Duration>(longest, limits_->max_channel_delay)) {
        admission.is_admitted = false;
        admission.is_known = std::exchange(source.is_refused, true);
        return admission;
    }
    source.is_refused = source.is_refused && admission.wait > Duration::zero();
    source.bucket.spend(admission.cost, now);
    return admission;
}

void ChannelGuard::failed(std::string_view name, TimePoint now)
{
    Source& source = find_or_add(name, now);
    forgive_in_time(source, now);
    if (source.failures == 0) {
        source.counted = now;
    }
    source.failures = std::min(source.failures + 1, 2 * limits_->max_channel_failures);
}

void ChannelGuard::worked(std::string_view name, Duration cost)
{
    if (Source* source = find(name)) {
        source->failures = 0;
        source->bucket.spent_until -= std::min(cost, source->bucket.spent_until.time_since_epoch());
    }
}

ConnectionGate::ConnectionGate(ChannelGuard& guard, const ServerLimits& limits,
                               std::string_view address)
    : guard_{guard}, limits_{limits}, source_{network_of(address)}
{
}

channel::OpenGate::Admission ConnectionGate::admit(bool is_renewal, Duration longest, TimePoint now)
{
    if (is_renewal) {
        const Duration interval = Duration{limits_.min_token_lifetime} / renewals_per_lifetime;
        const Duration wait = renewals_.wait(renewals_per_lifetime, interval, now);
        renewals_.spend(interval, now);
        return {.wait = wait};
    }
    const ChannelGuard::Admission admission = guard_.admit(source_, longest, now);
    cost_ = admission.cost;
    return {admission.is_admitted, admission.wait, admission.is_known};
}

} // namespace busbar::server::detail

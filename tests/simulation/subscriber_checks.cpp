#include "subscriber.hpp"

namespace busbar::test {

using namespace std::chrono_literals;

namespace {

/// The server has given an event to all items after that time.
constexpr Duration distribution = 500ms;

} // namespace

WatchedSubscription* Subscriber::find(std::uint32_t id)
{
    const auto found = subscriptions_.find(id);
    return found == subscriptions_.end() ? nullptr : &found->second;
}

Watch* Subscriber::find(std::uint32_t id, std::uint32_t handle)
{
    WatchedSubscription* const subscription = find(id);
    if (subscription == nullptr) {
        return nullptr;
    }
    const auto found = subscription->watches.find(handle);
    return found == subscription->watches.end() ? nullptr : &found->second;
}

bool Subscriber::is_subscription_lost(std::uint32_t id, StatusCode status)
{
    if (status != status::Bad_SubscriptionIdInvalid) {
        return false;
    }
    subscription_lost(id);
    return true;
}

void Subscriber::subscription_lost(std::uint32_t id)
{
    const WatchedSubscription& subscription = *find(id);
    if (parts_.scheduler.now() - subscription.last_use < subscription.least_lifetime()) {
        violation("subscription " + std::to_string(id) + " was lost before its lifetime");
    }
    parts_.trace.note(number_, "subscription lost", id);
    subscriptions_.erase(id);
}

void Subscriber::check_lifetime(const WatchedSubscription& subscription)
{
    const std::chrono::duration<double, std::milli> lifetime{subscription.longest_interval *
                                                             (subscription.lifetime_count + 1)};
    // So long the server may have answered to nobody, who seemed to be there.
    const Duration late = parts_.weather.max_notice + parts_.weather.max_stall;
    if (parts_.scheduler.now() - left_at_ > lifetime + late) {
        violation("subscription " + std::to_string(subscription.id) + " outlived its lifetime");
    }
}

void Subscriber::check_arrivals()
{
    if (!is_ready_) {
        return violation("is not back");
    }
    for (const auto& [id, subscription] : subscriptions_) {
        if (may_have_ended(subscription)) {
            continue;
        }
        for (const auto& [handle, watch] : subscription.watches) {
            const std::int64_t count = parts_.plant.count(watch.kind, watch.counter);
            // A value is sent anew after a gap; an event that was missed does not come back.
            const bool has_news = watch.kind != Plant::Kind::Event ||
                                  (next_event(watch) <= count && !watch.check.may_miss());
            if (watch.state == Watch::State::Live && watch.mode == MonitoringMode::Reporting &&
                has_news && watch.check.last() != count) {
                violation("subscription " + std::to_string(id) + ", item " +
                          std::to_string(handle) + " did not bring the last of " +
                          std::to_string(count));
            }
        }
    }
}

bool Subscriber::is_refused(StatusCode status, TimePoint asked)
{
    if (status != status::Bad_OutOfMemory) {
        return false;
    }
    parts_.trace.note(number_, "is refused");
    expect(parts_.memory.has_failed(asked), "there was memory", status);
    return true;
}

bool Subscriber::may_miss(const Watch& watch, std::int64_t number) const
{
    const TimePoint made = parts_.plant.time_of(watch.kind, watch.counter, number);
    if (watch.kind == Plant::Kind::Event) {
        return watch.loss_told >= made && parts_.memory.has_failed(made, made + distribution);
    }
    return watch.kind == Plant::Kind::Memory && parts_.memory.has_failed(made);
}

std::int64_t Subscriber::next_event(const Watch& watch) const
{
    const std::int64_t count = parts_.plant.count(watch.kind, watch.counter);
    std::int64_t next = watch.check.last().value_or(watch.first_count) + 1;
    while (next <= count && may_miss(watch, next)) {
        ++next;
    }
    return next;
}

void Subscriber::take_back_items()
{
    for (auto& [id, subscription] : subscriptions_) {
        for (auto& [handle, watch] : subscription.watches) {
            if (watch.state == Watch::State::Asked) {
                watch.state = Watch::State::Wanted;
            }
        }
    }
}

void Subscriber::expect(bool condition, const std::string& what, StatusCode status)
{
    if (!condition) {
        violation(what + ": " + std::string{name(status)});
    }
}

} // namespace busbar::test

#include <algorithm>

#include "subscriber.hpp"

namespace busbar::test {

using namespace std::chrono_literals;

namespace {

/// The server looks for what sources have completed a little later.
constexpr Duration server_turn = 250ms;
/// A client, or its link, is slow for so long at most.
constexpr Duration longest_slow = 90s;

/// From a request until its answer, over a link that nothing holds up. A client does one thing at a
/// time: it may have to wait for one answer before it asks for the next.
Duration turn(const Weather& weather)
{
    return 2 * (2 * usual_time(weather) + server_turn);
}

Duration sampling_time(const Watch& watch, std::uint32_t handle)
{
    const double interval = std::max(parameters_of(watch, handle).sampling_interval, 0.0);
    return std::chrono::duration_cast<Duration>(
               std::chrono::duration<double, std::milli>{interval}) +
           server_turn + (watch.kind == Plant::Kind::Memory ? LateSource::longest : Duration{0});
}

} // namespace

bool Subscriber::is_undisturbed() const
{
    return is_ready_ && !is_closing_ && !link_->is_cut() && !release_.is_set() &&
           *held_until_ <= parts_.scheduler.now();
}

Duration Subscriber::longest_notice() const
{
    return longest_slow + parts_.weather.max_stall + usual_time(parts_.weather);
}

void Subscriber::look()
{
    look_.set_after(10s);
    if (!is_undisturbed()) {
        return;
    }
    undisturbed_since_ = std::max({undisturbed_since_, *held_until_, parts_.memory.last_failure()});
    check_answer();
    for (const auto& [id, subscription] : subscriptions_) {
        if (!subscription.needs_transfer && subscription.interval) {
            check_message(subscription);
            check_values(subscription);
        }
    }
}

void Subscriber::check_answer()
{
    const TimePoint begin = std::max(step_sent_, undisturbed_since_);
    if (is_busy_ && parts_.scheduler.now() > begin + turn(parts_.weather) + LateSource::longest) {
        violation("a request got no answer in time");
    }
}

/// True if its lifetime may have run out before a connection was lost, and it has not been heard
/// since: the StatusChangeNotification that says so may have been under way, and cannot be asked
/// for again (Part 4, 5.14.1.1 and 5.14.6).
bool Subscriber::may_have_ended(const WatchedSubscription& subscription) const
{
    const bool is_heard = subscription.last_heard && *subscription.last_heard >= left_at_;
    return !is_heard && left_at_ - subscription.last_use >= subscription.least_lifetime();
}

/// Part 4, 5.14.1.1: the first message within the first publishing interval, later ones at least
/// within the keep-alive time.
void Subscriber::check_message(const WatchedSubscription& subscription)
{
    if (may_have_ended(subscription)) {
        return;
    }
    const TimePoint begin =
        std::max({undisturbed_since_, subscription.undisturbed_since,
                  subscription.last_heard.value_or(subscription.undisturbed_since)});
    // The first one may have been sent while nothing could arrive.
    const bool is_first = !subscription.last_heard && subscription.created >= undisturbed_since_;
    const Duration allowed =
        subscription.cycle() * (is_first ? 1 : subscription.keep_alive_count + 1);
    if (parts_.scheduler.now() > begin + allowed + sending_time(subscription)) {
        violation("subscription " + std::to_string(subscription.id) +
                  " has been silent for longer than its keep-alive time");
    }
}

/// Each value is sampled, waits for the end of the publishing interval, and for its turn.
void Subscriber::check_values(const WatchedSubscription& subscription)
{
    if (subscription.publishing != true || !subscription.is_caught_up ||
        subscription.needs_values || subscription.sequence.has_gap()) {
        return;
    }
    for (const auto& [handle, watch] : subscription.watches) {
        // Events that were lost with a message do not come back.
        const bool is_sure = watch.kind != Plant::Kind::Storm &&
                             watch.state == Watch::State::Live &&
                             watch.mode == MonitoringMode::Reporting &&
                             (watch.kind != Plant::Kind::Event || !watch.check.may_miss());
        const std::int64_t count = parts_.plant.count(watch.kind, watch.counter);
        const std::int64_t next = watch.kind == Plant::Kind::Event
                                      ? next_event(watch)
                                      : watch.check.last().value_or(-1) + 1;
        if (!is_sure || count < next) {
            continue;
        }
        const TimePoint made = parts_.plant.time_of(watch.kind, watch.counter, next);
        const TimePoint begin =
            std::max({made, undisturbed_since_, subscription.undisturbed_since, watch.since});
        const Duration allowed = sampling_time(watch, handle) + subscription.cycle();
        if (parts_.scheduler.now() > begin + allowed + sending_time(subscription)) {
            violation("subscription " + std::to_string(subscription.id) + ", item " +
                      std::to_string(handle) + ": " + std::to_string(next) +
                      " has not come in time");
        }
    }
}

/// Part 4, 5.14.2.2: before a Subscription come those of higher priority, with all they have; those
/// of equal priority have their turn after each of its messages.
Duration Subscriber::sending_time(const WatchedSubscription& subscription) const
{
    const std::size_t own = subscription.messages();
    std::size_t turns = 1 + own;
    for (const auto& [id, other] : subscriptions_) {
        const std::size_t most = other.messages();
        if (id != subscription.id) {
            turns += other.priority > subscription.priority ? most : std::min(own, most);
        }
    }
    return turn(parts_.weather) * turns;
}

void Subscriber::slow_down()
{
    slow_.set_after(chance_.between(10min, 2h));
    const std::size_t what = chance_.below(3);
    const Duration time =
        chance_.one_in(2) ? chance_.between(100ms, 3s) : chance_.between(3s, longest_slow);
    if (!is_ready_ || link_->is_cut()) {
        return;
    }
    parts_.trace.note(number_, "is slow");
    if (what != 0) {
        link_->hold(Side::Server); // does not read
    }
    if (what != 1) {
        link_->hold(Side::Client); // does not write; with both nobody knows of anybody
    }
    release_.set_after(time);
}

void Subscriber::speed_up()
{
    undisturbed_since_ = parts_.scheduler.now();
    link_->release(Side::Client);
    link_->release(Side::Server);
}

} // namespace busbar::test

#include "ended_subscriptions.hpp"

#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "subscription.hpp"

namespace busbar::server::detail {

namespace {

/// Up to this number, items are deleted at once.
constexpr std::size_t items_at_once = 16;
/// Deleting an item takes some microseconds.
constexpr std::size_t items_of_sweep = 200;

} // namespace

EndedSubscriptions::EndedSubscriptions(TimerQueue& timers) : timers_{timers} {}

EndedSubscriptions::~EndedSubscriptions()
{
    timers_.cancel(*this);
}

void EndedSubscriptions::add(std::unique_ptr<Subscription> subscription)
{
    if (subscription->item_count() > items_at_once) {
        busbar::detail::attempt([&] { // otherwise it is deleted at once
            timers_.set(*this, TimePoint::min());
            all_.push_back(std::move(subscription));
        });
    }
}

bool EndedSubscriptions::sweep(std::size_t items) noexcept
{
    const bool has_some = !all_.empty();
    while (items != 0 && !all_.empty()) {
        Subscription& last = *all_.back();
        items -= last.remove_items(items);
        if (last.item_count() == 0) {
            all_.pop_back();
        }
    }
    return has_some;
}

void EndedSubscriptions::clear()
{
    all_.clear();
    timers_.cancel(*this);
}

void EndedSubscriptions::expire(TimePoint /*now*/)
{
    // As in Subscription::expire: re-arm first, so that a throw below cannot stop the timer.
    timers_.set(*this, TimePoint::min());
    static_cast<void>(sweep(items_of_sweep));
    if (all_.empty()) {
        timers_.cancel(*this);
    }
}

} // namespace busbar::server::detail

#include "ended_subscriptions.hpp"

#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "subscription.hpp"

namespace busbar::server::detail {

namespace {

/// So few are not worth an errand.
constexpr std::size_t items_at_once = 16;
/// An item is gone within some microseconds.
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
        busbar::detail::attempt([&] { // else it goes at once
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
    // First, as in Subscription::expire: whatever happens here, it goes on.
    timers_.set(*this, TimePoint::min());
    static_cast<void>(sweep(items_of_sweep));
    if (all_.empty()) {
        timers_.cancel(*this);
    }
}

} // namespace busbar::server::detail

#pragma once

#include <cstddef>
#include <vector>

#include "timer_queue.hpp"

namespace busbar::server::detail {

class Subscription;

/// Subscriptions whose items are looked at one after the other, since their user has changed or
/// their last values are sent again. That takes a few items at a time, after all other work that is
/// due, and nothing of the Subscription is published until it is complete.
class ItemReviews final : public Timer {
public:
    /// The number of items that are looked at within the request that makes it necessary.
    static constexpr std::size_t items_at_once = 200;

    /// `timers` must outlive this object.
    explicit ItemReviews(TimerQueue& timers) : timers_{timers} {}
    ~ItemReviews() override;

    /// Looks at up to `most` items of the Subscription now and at the others later, and returns
    /// their number. The Subscription must stay until remove().
    std::size_t begin(Subscription& subscription, TimePoint now, std::size_t most = items_at_once);
    void remove(const Subscription& subscription) noexcept;
    void expire(TimePoint now) override;

private:
    TimerQueue& timers_;
    std::vector<Subscription*> all_;
};

} // namespace busbar::server::detail

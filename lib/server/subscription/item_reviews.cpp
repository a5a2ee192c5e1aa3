#include "item_reviews.hpp"

#include <algorithm>

#include <busbar/core/detail/guarded.hpp>

#include "publish_queue.hpp"
#include "subscription.hpp"

namespace busbar::server::detail {

ItemReviews::~ItemReviews()
{
    timers_.cancel(*this);
}

std::size_t ItemReviews::begin(Subscription& subscription, TimePoint now, std::size_t most)
{
    const std::size_t count = subscription.review(now, most);
    if (!subscription.is_in_review() ||
        std::find(all_.begin(), all_.end(), &subscription) != all_.end()) {
        return count;
    }
    const StatusCode lack = busbar::detail::caught([&] {
        all_.reserve(all_.size() + 1);
        timers_.set(*this, TimePoint::min());
        all_.push_back(&subscription);
    });
    if (lack.is_bad()) {
        while (subscription.is_in_review()) {
            static_cast<void>(subscription.review(now, items_at_once));
        }
    }
    return count;
}

void ItemReviews::remove(const Subscription& subscription) noexcept
{
    std::erase(all_, &subscription);
}

void ItemReviews::expire(TimePoint now)
{
    // Re-arm first, so that a throw below cannot stop the timer.
    timers_.set(*this, TimePoint::min());
    for (std::size_t room = items_at_once; room != 0 && !all_.empty();) {
        Subscription& next = *all_.front();
        room -= next.review(now, room);
        if (!next.is_in_review()) {
            all_.erase(all_.begin());
            if (next.session() != nullptr) {
                PublishPart::of(*next.session()).serve(now);
            }
        }
    }
    if (all_.empty()) {
        timers_.cancel(*this);
    }
}

} // namespace busbar::server::detail

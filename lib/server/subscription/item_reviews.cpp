#include "item_reviews.hpp"

#include <algorithm>
#include <chrono>

#include <busbar/core/detail/guarded.hpp>

#include "publish_queue.hpp"
#include "sampler.hpp"
#include "subscription.hpp"

namespace busbar::server::detail {

namespace {

constexpr std::chrono::milliseconds pause_after_throw{50};

/// Returns whether a Publish request waits for the Subscription.
bool is_awaited(const Subscription& subscription)
{
    return subscription.session() != nullptr &&
           PublishPart::of(*subscription.session()).next_request() != nullptr;
}

} // namespace

void ItemReviews::add(Subscription& subscription) noexcept
{
    due_ = TimePoint::min();
    if (subscription.is_listed_) {
        return;
    }
    subscription.is_listed_ = true;
    subscription.previous_listed_ = last_;
    (last_ != nullptr ? last_->next_listed_ : first_) = &subscription;
    last_ = &subscription;
}

void ItemReviews::remove(Subscription& subscription) noexcept
{
    if (!subscription.is_listed_) {
        return;
    }
    Subscription* const previous = subscription.previous_listed_;
    Subscription* const next = subscription.next_listed_;
    (previous != nullptr ? previous->next_listed_ : first_) = next;
    (next != nullptr ? next->previous_listed_ : last_) = previous;
    subscription.is_listed_ = false;
    subscription.previous_listed_ = subscription.next_listed_ = nullptr;
    if (first_ == nullptr) {
        due_ = no_deadline;
    }
}

bool ItemReviews::review(Subscription& subscription, TimePoint now, std::size_t& room)
{
    const std::size_t before = room;
    const StatusCode thrown = busbar::detail::guarded(log_, "a review of MonitoredItems",
                                                      [&] { subscription.review(now, room); });
    room = std::min(room, before - 1);
    if (thrown.is_bad()) {
        // Until it is repeated nothing is sampled with the rights of another user.
        sampler_.look_up_again();
    }
    return thrown.is_good();
}

std::size_t ItemReviews::begin(Subscription& subscription, TimePoint now, std::size_t room)
{
    if (room == 0) {
        return 0;
    }
    const std::size_t before = room;
    // One that is awaited is served by expire(), outside of the request.
    if (review(subscription, now, room) && !subscription.is_in_review() &&
        !is_awaited(subscription)) {
        remove(subscription);
    }
    return before - room;
}

void ItemReviews::expire(TimePoint now)
{
    if (due_ > now) {
        return;
    }
    const Subscription* thrower = nullptr; // the first in this call
    for (std::size_t room = items_at_once; room != 0 && first_ != nullptr && first_ != thrower;) {
        Subscription& next = *first_;
        if (!review(next, now, room)) {
            remove(next);
            add(next); // after the others, which do not wait for it
            thrower = thrower != nullptr ? thrower : &next;
            continue;
        }
        if (next.is_in_review()) {
            break; // there is no room
        }
        remove(next);
        if (is_awaited(next)) {
            busbar::detail::guarded(log_, "a Publish response",
                                    [&] { PublishPart::of(*next.session()).serve(now); });
        }
    }
    if (first_ != nullptr) {
        due_ = first_ == thrower ? now + pause_after_throw : TimePoint::min();
    }
}

} // namespace busbar::server::detail

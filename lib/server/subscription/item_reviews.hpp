#pragma once

#include <cstddef>

#include <busbar/core/clock.hpp>

namespace busbar {
class LogSink;
} // namespace busbar

namespace busbar::server::detail {

class Sampler;
class Subscription;

/// Subscriptions whose items are looked at one after the other, since their user has changed or
/// their last values are sent again. That takes a few items at a time, after all other work that is
/// due, and nothing of the Subscription is published until it is complete.
///
/// An item that throws is logged and looked at again after a pause; other Subscriptions do not wait
/// for it. The links of the list are in the Subscriptions: nothing is allocated.
class ItemReviews {
public:
    /// The number of items that are looked at within the request that makes it necessary, and in
    /// each call of expire(). A Subscription without items counts as one.
    static constexpr std::size_t items_at_once = 200;

    /// `sampler` and `log` must outlive this object.
    ItemReviews(Sampler& sampler, LogSink& log) : sampler_{sampler}, log_{log} {}
    ItemReviews(const ItemReviews&) = delete;
    ItemReviews& operator=(const ItemReviews&) = delete;

    /// The Subscription's items must be looked at. It must stay until remove().
    void add(Subscription& subscription) noexcept;
    void remove(Subscription& subscription) noexcept;
    /// Looks at up to `room` items of an added Subscription now, and leaves the others, and all
    /// that throw, to expire(). Returns how much of `room` that took: at least 1, unless that is 0.
    std::size_t begin(Subscription& subscription, TimePoint now, std::size_t room = items_at_once);

    /// Returns no_deadline if there is nothing to do.
    [[nodiscard]] TimePoint next_deadline() const { return due_; }
    /// Call after all other work that is due; does nothing before next_deadline().
    void expire(TimePoint now);

private:
    /// Returns false if it threw.
    bool review(Subscription& subscription, TimePoint now, std::size_t& room);

    Sampler& sampler_;
    LogSink& log_;
    Subscription* first_{nullptr};
    Subscription* last_{nullptr};
    TimePoint due_{no_deadline};
};

} // namespace busbar::server::detail

#pragma once

#include <cstddef>
#include <vector>

#include <busbar/core/clock.hpp>

namespace busbar::server::detail {

class TimerQueue;

/// An object that is due at a time; in at most one queue.
class Timer {
public:
    Timer() = default;
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;
    virtual ~Timer() = default;

    /// Returns no_deadline if it is not set.
    [[nodiscard]] TimePoint due() const { return due_; }

    /// Called at the due time; the timer is not set any more. May set or cancel any timer.
    virtual void expire(TimePoint now) = 0;
    /// Among timers that expire in one call the highest rank comes first, then the one that was due
    /// first.
    [[nodiscard]] virtual unsigned rank() const { return 0; }

private:
    friend class TimerQueue;

    TimePoint due_{no_deadline};
    std::size_t place_{0};
    bool is_expiring_{false};
};

/// Timers by their due time: a binary heap, so that idle timers cost nothing and a change takes a
/// number of steps that grows with the logarithm of their number.
class TimerQueue {
public:
    /// `timer` must be cancelled before it is destroyed. Needs memory only for a timer that is
    /// neither set nor expiring: a periodic timer can always be set again.
    void set(Timer& timer, TimePoint due);
    void cancel(Timer& timer);
    [[nodiscard]] TimePoint next_deadline() const
    {
        if (has_rest_) {
            return TimePoint::min();
        }
        return heap_.empty() ? no_deadline : heap_.front()->due_;
    }
    /// Expires all timers that are due at `now` when it is called; those that set themselves to a
    /// time that has passed wait for the next call. A Timer's exception is passed on; the timers
    /// that were due after it wait for the next call, which is due at once.
    void expire(TimePoint now);
    [[nodiscard]] std::size_t size() const { return heap_.size(); }

private:
    class Expiring;

    [[nodiscard]] bool has_place(const Timer& timer) const;
    void make_place();
    void put(Timer& timer, std::size_t place);
    void sift_up(Timer& timer, std::size_t place);
    void sift_down(Timer& timer, std::size_t place);

    /// Has room for the expiring ones as well.
    std::vector<Timer*> heap_;
    /// Due in this call of expire(); null if one was cancelled meanwhile.
    std::vector<Timer*> expiring_;
    /// The timer that expires now, until it is set again or cancelled.
    Timer* current_{nullptr};
    /// A throwing timer left others there.
    bool has_rest_{false};
};

} // namespace busbar::server::detail

#pragma once

#include <exception>
#include <utility>

#include <asio/steady_timer.hpp>

#include <busbar/core/clock.hpp>

namespace busbar::net::detail {

inline TimePoint now()
{
    return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
}

/// `timeout` from now; a timeout that never ends is a deadline that never comes.
inline TimePoint after(Duration timeout)
{
    const TimePoint start = now();
    return timeout >= no_deadline - start ? no_deadline : start + timeout;
}

/// Has `timer` wait no more.
inline void stop(asio::steady_timer& timer) noexcept
{
    try {
        timer.cancel();
    } catch (const std::exception&) {
        return; // declared by Asio, which has no error here that it could report
    }
}

/// Waits for the next deadline of an engine, which may be another after every call. Most are later
/// than the one before, as each message that comes puts a timeout off: the system is not asked
/// then, and what goes off early waits on.
class DeadlineTimer {
public:
    explicit DeadlineTimer(const asio::any_io_executor& executor) : timer_{executor} {}

    /// Calls `on_deadline`, which is the same in every call, when it is time, instead of when an
    /// earlier call wanted it. It has to keep the timer's owner alive: Asio may look at the timer
    /// after cancel(). Where there is no memory to wait on, it is called too early.
    template <typename OnDeadline>
    void await(TimePoint deadline, OnDeadline on_deadline)
    {
        wanted_ = deadline;
        if (deadline == no_deadline) {
            cancel();
        } else if (deadline < awaited_) {
            wait(on_deadline);
        }
    }
    void cancel()
    {
        awaited_ = no_deadline;
        stop(timer_);
    }

private:
    template <typename OnDeadline>
    void wait(const OnDeadline& on_deadline)
    {
        cancel();
        timer_.expires_at(wanted_);
        timer_.async_wait([this, deadline = wanted_, on_deadline](std::error_code error) {
            if (!error && awaited_ == deadline) {
                awaited_ = no_deadline;
                go_off(deadline, on_deadline);
            }
        });
        awaited_ = wanted_;
    }
    template <typename OnDeadline>
    void go_off(TimePoint deadline, const OnDeadline& on_deadline)
    {
        if (wanted_ > deadline) {
            try {
                wait(on_deadline);
                return;
            } catch (const std::exception&) {
                awaited_ = no_deadline; // whoever is called waits anew, or ends
            }
        }
        on_deadline();
    }

    asio::steady_timer timer_;
    TimePoint wanted_{no_deadline};
    TimePoint awaited_{no_deadline}; // that of the timer, as long as it waits
};

} // namespace busbar::net::detail

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

/// Returns the time `timeout` from now; no_deadline for a timeout that never ends.
inline TimePoint after(Duration timeout)
{
    const TimePoint start = now();
    return timeout >= no_deadline - start ? no_deadline : start + timeout;
}

/// Makes `timer` stop waiting.
inline void stop(asio::steady_timer& timer) noexcept
{
    try {
        timer.cancel();
    } catch (const std::exception&) {
        return; // Asio declares an error code, but has no error to report here
    }
}

/// Waits for the next deadline of an engine, which may change with every call. Most are later than
/// the previous one, as each message that arrives postpones a timeout: the system timer is not set
/// again then, and a wait that ends early continues.
class DeadlineTimer {
public:
    explicit DeadlineTimer(const asio::any_io_executor& executor) : timer_{executor} {}

    /// Calls `on_deadline`, the same in every call, at the deadline, instead of at an earlier one.
    /// It must keep the timer's owner alive: Asio may access the timer after cancel(). Without
    /// memory for the wait, it is called too early.
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
                awaited_ = no_deadline; // the handler waits again, or ends
            }
        }
        on_deadline();
    }

    asio::steady_timer timer_;
    TimePoint wanted_{no_deadline};
    TimePoint awaited_{no_deadline}; // the timer's deadline, as long as it waits
};

} // namespace busbar::net::detail

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

/// Waits for the next deadline of an engine, which may be another after every call.
class DeadlineTimer {
public:
    explicit DeadlineTimer(const asio::any_io_executor& executor) : timer_{executor} {}

    /// Calls `on_deadline` when it is time, instead of what an earlier call asked for. It has to
    /// keep the timer's owner alive: Asio may look at the timer after cancel().
    template <typename OnDeadline>
    void await(TimePoint deadline, OnDeadline on_deadline)
    {
        if (deadline == awaited_) {
            return;
        }
        awaited_ = no_deadline; // as long as nothing waits
        stop(timer_);
        if (deadline == no_deadline) {
            return;
        }
        timer_.expires_at(deadline);
        timer_.async_wait(
            [this, deadline, on_deadline = std::move(on_deadline)](std::error_code error) mutable {
                if (!error && awaited_ == deadline) {
                    awaited_ = no_deadline;
                    on_deadline();
                }
            });
        awaited_ = deadline;
    }
    void cancel()
    {
        awaited_ = no_deadline;
        stop(timer_);
    }

private:
    asio::steady_timer timer_;
    TimePoint awaited_{no_deadline};
};

} // namespace busbar::net::detail

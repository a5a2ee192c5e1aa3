#pragma once

#include <cstdint>

#include <busbar/core/clock.hpp>

namespace busbar::client::detail {

/// Decides when to send a request to a silent server, and when to give up.
class KeepAlive {
public:
    enum class Action : std::uint8_t { None, Ask, GiveUp };

    /// Starts again; with an interval of zero it never asks.
    void start(TimePoint now, Duration interval)
    {
        interval_ = interval;
        heard(now);
    }
    void stop() { deadline_ = no_deadline; }
    void heard(TimePoint now)
    {
        unanswered_ = 0;
        deadline_ = interval_ > Duration::zero() ? now + interval_ : no_deadline;
    }
    [[nodiscard]] Action due(TimePoint now)
    {
        if (now < deadline_) {
            return Action::None;
        }
        if (unanswered_ == 2) {
            return Action::GiveUp;
        }
        ++unanswered_;
        deadline_ = now + interval_;
        return Action::Ask;
    }
    [[nodiscard]] TimePoint next_deadline() const { return deadline_; }
    [[nodiscard]] Duration interval() const { return interval_; }

private:
    Duration interval_{0};
    TimePoint deadline_{no_deadline};
    int unanswered_{0};
};

} // namespace busbar::client::detail

#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "harness_names.hpp"

namespace busbar::test {

/// The longest that bytes are on their way over a link that does not hold them up, in one
/// direction: three parts, each up to half of the latency later than the one before.
[[nodiscard]] inline Duration usual_time(const Weather& weather)
{
    return weather.max_latency * 3 / 2;
}

/// Sees how long the network holds up what both ends send.
class LinkWatch final : public LinkFilter {
public:
    /// Up to then something is held up.
    using HeldUntil = std::shared_ptr<TimePoint>;

    LinkWatch(const Weather& weather, HeldUntil held_until)
        : weather_{&weather}, held_until_{std::move(held_until)}
    {
    }

    void pass(Link& link, Side from, std::span<const std::byte> bytes) override
    {
        link.send(from, bytes);
        const TimePoint arrival = link.last_arrival(from);
        if (arrival > link.scheduler().now() + usual_time(*weather_)) {
            *held_until_ = std::max(*held_until_, arrival);
        }
    }

private:
    const Weather* weather_;
    HeldUntil held_until_;
};

} // namespace busbar::test

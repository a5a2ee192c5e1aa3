#pragma once

#include <cstdint>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/detail/chrono.hpp>

namespace busbar {

/// Monotonic time, which the program that drives an engine passes to it; engines never ask a clock.
using Duration = std::chrono::nanoseconds;
/// A moment of the monotonic clock that engines are given; wall clock times are DateTime.
using TimePoint = std::chrono::time_point<std::chrono::steady_clock, Duration>;

/// A Duration in milliseconds, the unit of a Duration in services (Part 3, 8.13).
[[nodiscard]] constexpr double to_milliseconds(Duration duration)
{
    return std::chrono::duration<double, std::milli>{duration}.count();
}

/// A deadline that never comes.
inline constexpr TimePoint no_deadline = TimePoint::max();

/// The difference between local time and UTC (Part 3, 8.28).
struct TimeZone {
    /// Minutes to add to UTC, including daylight saving time if daylight_saving_in_offset is set.
    std::int16_t offset{0};
    bool daylight_saving_in_offset{false};

    friend bool operator==(const TimeZone&, const TimeZone&) = default;
};

/// The time of day, injected where a message needs it (timestamps, certificate validity).
class BUSBAR_API WallClock {
public:
    WallClock() = default;
    WallClock(const WallClock&) = delete;
    WallClock& operator=(const WallClock&) = delete;
    virtual ~WallClock() = default;

    /// UTC now. Called from any thread.
    [[nodiscard]] virtual DateTime now() const = 0;
    /// The time zone of the machine's place, now; the default is UTC. Called from any thread.
    [[nodiscard]] virtual TimeZone time_zone() const { return {}; }
};

} // namespace busbar

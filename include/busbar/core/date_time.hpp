#pragma once

#include <compare>
#include <cstdint>
#include <iosfwd>

#include <busbar/core/api.hpp>

namespace busbar {

/// DateTime (Part 6, 5.2.2.5): 100 ns ticks since 1601-01-01T00:00:00Z. Zero means "no time".
struct DateTime {
    std::int64_t ticks{0};

    static constexpr std::int64_t ticks_per_second = 10'000'000;
    /// Ticks from 1601-01-01 to 1970-01-01.
    static constexpr std::int64_t unix_epoch = 116'444'736'000'000'000;
    /// 9999-12-31T23:59:59Z; this and anything later is encoded as the largest Int64.
    static constexpr std::int64_t latest = 2'650'467'743'990'000'000;

    /// Seconds since 1970-01-01T00:00:00Z; a fraction is lost.
    [[nodiscard]] static constexpr DateTime from_unix_seconds(std::int64_t seconds)
    {
        return {unix_epoch + seconds * ticks_per_second};
    }
    /// `ticks` of 100 ns since 1970-01-01.
    [[nodiscard]] static constexpr DateTime from_unix_ticks(std::int64_t ticks)
    {
        return {unix_epoch + ticks};
    }
    /// Seconds since 1970-01-01T00:00:00Z; a fraction is lost.
    [[nodiscard]] constexpr std::int64_t unix_seconds() const
    {
        return (ticks - unix_epoch) / ticks_per_second;
    }
    [[nodiscard]] constexpr bool is_null() const { return ticks <= 0; }
    /// The value as it is encoded: 0 before 1601, the largest Int64 after 9999.
    [[nodiscard]] constexpr std::int64_t clamped() const
    {
        return ticks <= 0 ? 0 : (ticks >= latest ? INT64_MAX : ticks);
    }

    // NOLINTNEXTLINE(modernize-use-nullptr): the compiler's own comparison has a 0
    friend constexpr auto operator<=>(DateTime, DateTime) = default;
};

/// "2026-11-21T06:00:00.1234567Z", trailing zeros of the fraction left out.
[[nodiscard]] BUSBAR_API std::string to_string(DateTime time);

} // namespace busbar

#pragma once

#include <busbar/core/status_codes.hpp>

#include "tool/watch/model.hpp"

/// Values at times that a test chooses.
namespace busbar::test {

inline constexpr DateTime noon = DateTime::from_unix_seconds(1'795'262'400); // 2026-11-21T12:00:00Z

inline tool::watch::Now at(Duration since_start)
{
    const auto ticks = since_start.count() / (1'000'000'000 / DateTime::ticks_per_second);
    return {TimePoint{std::chrono::hours{1}} + since_start, DateTime{noon.ticks + ticks}};
}

inline DataValue value_of(Variant variant, StatusCode status = {})
{
    DataValue value;
    value.value = std::move(variant);
    value.status = status;
    value.source_timestamp = noon;
    value.server_timestamp = noon;
    return value;
}

} // namespace busbar::test

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>

/// Durations, dates and times of day as literals of IEC 61131-3.
namespace busbar::detail {

/// Reads what follows the # of T#: milliseconds.
[[nodiscard]] BUSBAR_API std::optional<double> read_duration(std::string_view text);
/// Reads what follows the # of D#, TOD# and DT#; a time of day is one on the first day of DateTime.
[[nodiscard]] BUSBAR_API std::optional<DateTime> read_date(std::string_view text);
[[nodiscard]] BUSBAR_API std::optional<DateTime> read_time_of_day(std::string_view text);
[[nodiscard]] BUSBAR_API std::optional<DateTime> read_date_and_time(std::string_view text);

/// Removes underscores between two digits; returns nothing if one stands elsewhere.
[[nodiscard]] BUSBAR_API std::optional<std::string> without_underscores(std::string_view text);

/// Returns "T#1m30s500ms".
[[nodiscard]] BUSBAR_API std::string duration_text(std::int64_t nanoseconds);
/// Returns "TOD#06:00:00.5" for a time since midnight, 0 or more.
[[nodiscard]] BUSBAR_API std::string time_of_day_text(std::int64_t nanoseconds);
/// Returns "D#2026-11-29".
[[nodiscard]] BUSBAR_API std::string date_text(DateTime time);
/// Returns "DT#2026-11-29-06:00:00.5".
[[nodiscard]] BUSBAR_API std::string date_and_time_text(DateTime time);

} // namespace busbar::detail

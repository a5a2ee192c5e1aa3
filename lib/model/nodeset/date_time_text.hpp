#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/date_time.hpp>

namespace busbar::nodeset {

/// Reads xs:dateTime or xs:date, with or without fraction and offset; without offset it is UTC
/// (Part 6, 5.3.1.6). A time outside the range of DateTime becomes one of its ends.
[[nodiscard]] std::optional<DateTime> parse_date_time(std::string_view text);

/// Returns a text that parse_date_time reads as the same time.
[[nodiscard]] std::string date_time_text(DateTime time);

} // namespace busbar::nodeset

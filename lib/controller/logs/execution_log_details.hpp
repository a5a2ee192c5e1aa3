#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/date_time.hpp>
#include <busbar/core/record.hpp>

namespace busbar::controller::detail {

/// A record of the execution log on its way: names are unique over all categories.
struct LogDetails {
    std::string_view log_name;
    std::string details; // may still be too long
};

[[nodiscard]] bool has_log_rule(RecordKind kind);
[[nodiscard]] std::vector<LogDetails> log_details(const Record& record, DateTime now);

} // namespace busbar::controller::detail

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/date_time.hpp>
#include <busbar/core/record.hpp>

namespace busbar::controller::detail {

/// A record for the execution log; names are unique over all categories.
struct LogDetails {
    std::string_view log_name;
    std::string details; // may exceed the limit
};

[[nodiscard]] bool has_log_rule(RecordKind kind);
[[nodiscard]] std::vector<LogDetails> log_details(const Record& record, DateTime now);

} // namespace busbar::controller::detail

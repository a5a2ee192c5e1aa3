#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/record.hpp>

namespace busbar::controller {

/// A kind of entry of the execution log (W588, 7-1-6).
struct ExecutionLogCode {
    std::string_view category; // "SERVER", "AUTH", "CERT"
    std::uint16_t code;        // unique in its category
    std::string_view name;     // "PublishedVariable"
    std::string_view meaning;
};

/// Returns all 22, ordered by category and code.
[[nodiscard]] BUSBAR_API std::span<const ExecutionLogCode> execution_log_codes();

/// Maximum bytes of a record with its line end, and of the details in it (manual of variables mode,
/// 7-1-5 and 7-1-6).
inline constexpr std::size_t max_execution_log_record = 256;
inline constexpr std::size_t max_execution_log_details = 168;

/// A record of the execution log, without number and time.
struct ExecutionLogItem {
    const ExecutionLogCode* code; // one of execution_log_codes()
    /// Separated by tabs; contains no other control characters, and is UTF-8.
    std::string details;
};

/// Returns whether records of this kind may be in the log.
[[nodiscard]] BUSBAR_API bool is_in_execution_log(RecordKind kind);

/// Converts something that happened at `now`: to nothing, one record, or two. Names are cut at 60
/// bytes, file names at 65, between characters; "?" replaces control characters and bytes that are
/// not UTF-8.
[[nodiscard]] BUSBAR_API std::vector<ExecutionLogItem> execution_log_items(const Record& record,
                                                                           DateTime now);

/// Returns the record as in a file, with CR and LF: at most max_execution_log_record bytes. Times
/// are in `zone`.
[[nodiscard]] BUSBAR_API std::string execution_log_record(std::uint16_t serial_number,
                                                          DateTime time, TimeZone zone,
                                                          const ExecutionLogItem& item);

} // namespace busbar::controller

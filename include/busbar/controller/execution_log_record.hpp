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

/// What can stand in the execution log (seed 000, 7-1-6).
struct ExecutionLogCode {
    std::string_view category; // "SERVER", "AUTH", "CERT"
    std::uint16_t code;        // unique in its category
    std::string_view name;     // "PublishedVariable"
    std::string_view meaning;
};

/// All 22, by category and code.
[[nodiscard]] BUSBAR_API std::span<const ExecutionLogCode> execution_log_codes();

/// Bytes of a record with its line end, and of the details in it (seed 000, 7-1-5 and 7-1-6).
inline constexpr std::size_t max_execution_log_record = 256;
inline constexpr std::size_t max_execution_log_details = 168;

/// What a record of the execution log says, without number and time.
struct ExecutionLogItem {
    const ExecutionLogCode* code; // of execution_log_codes()
    /// With tabs between them; nothing else in it is a control character, and all of it is UTF-8.
    std::string details;
};

/// Whether records of this kind can come into the log.
[[nodiscard]] BUSBAR_API bool is_in_execution_log(RecordKind kind);

/// What becomes of something that happened, at `now`: nothing, a record, or two. Names are cut at
/// 60 bytes, of files at 65, and at the edge of a character; "?" stands for control characters and
/// for what is not UTF-8.
[[nodiscard]] BUSBAR_API std::vector<ExecutionLogItem> execution_log_items(const Record& record,
                                                                           DateTime now);

/// The record as it stands in a file, with CR and LF: at most max_execution_log_record bytes. Times
/// are those of `zone`.
[[nodiscard]] BUSBAR_API std::string execution_log_record(std::uint16_t serial_number,
                                                          DateTime time, TimeZone zone,
                                                          const ExecutionLogItem& item);

} // namespace busbar::controller

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/execution_log_record.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::controller {

/// A record of an execution log, as read back.
struct ExecutionLogEntry {
    std::uint16_t serial_number{0};
    DateTime time; // local time of the controller, encoded as if it were UTC
    const ExecutionLogCode* code{nullptr};
    std::string details; // as in ExecutionLogItem
};

/// Returns nothing for a line that is not a record (W588, 7-1-6). Without CR
/// and LF.
[[nodiscard]] BUSBAR_API std::optional<ExecutionLogEntry>
parse_execution_log_record(std::string_view line);

/// A filter: all given criteria must match.
struct ExecutionLogFilter {
    std::string category{}; // "AUTH"; empty: any
    std::optional<std::uint16_t> code{};
    DateTime from{};    // local time of the controller; null: any
    DateTime to{};      // and before this
    std::string text{}; // in the log name or the details, letters of ASCII in either case
};
/// True if the filter selects the entry.
[[nodiscard]] BUSBAR_API bool matches(const ExecutionLogEntry& entry,
                                      const ExecutionLogFilter& filter);

/// The records that a filter selects.
struct ExecutionLogContents {
    /// The oldest first.
    std::vector<ExecutionLogEntry> entries;
    /// There were older matching entries.
    bool is_cut{false};
    /// The number of lines that are not records, and of files too large for this log.
    std::size_t damaged{0};
};

/// Returns the last matching entries, at most `max_entries`, of the text of a file. A last line
/// without its end is still being written, and is ignored.
[[nodiscard]] BUSBAR_API ExecutionLogContents read_execution_log(std::string_view text,
                                                                 const ExecutionLogFilter& filter,
                                                                 std::size_t max_entries);

/// Reads all files of a folder in the same way, while they may be written: a file that becomes full
/// meanwhile may be read twice or not at all.
[[nodiscard]] BUSBAR_API Stored<ExecutionLogContents>
read_execution_log(Storage& storage, std::string_view folder, const ExecutionLogFilter& filter,
                   std::size_t max_entries);

/// The columns that a log is shown in (W588, 7-2-2).
inline constexpr std::array<std::string_view, 6> execution_log_column_names{
    "Entry", "Date/Time", "Category", "Log Code", "Log Name", "Details"};
/// Returns the text of each column: "7", "2017/10/17/14:52:50.878", "SERVER", "0005", "Run", "".
/// Details are separated by single spaces.
[[nodiscard]] BUSBAR_API std::array<std::string, 6>
execution_log_columns(const ExecutionLogEntry& entry);

} // namespace busbar::controller

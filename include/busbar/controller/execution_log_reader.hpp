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

/// A record of an execution log, read again.
struct ExecutionLogEntry {
    std::uint16_t serial_number{0};
    DateTime time; // of the controller's place, as if that were UTC
    const ExecutionLogCode* code{nullptr};
    std::string details; // as ExecutionLogItem has them
};

/// Nothing for a line that is no record (seed 000, 7-1-6). Without CR and LF.
[[nodiscard]] BUSBAR_API std::optional<ExecutionLogEntry>
parse_execution_log_record(std::string_view line);

/// What to look for: all that is given must fit.
struct ExecutionLogFilter {
    std::string category{}; // "AUTH"; empty: any
    std::optional<std::uint16_t> code{};
    DateTime from{};    // of the controller's place; null: any
    DateTime to{};      // and before this
    std::string text{}; // in the log name or the details, letters of ASCII in either case
};
[[nodiscard]] BUSBAR_API bool matches(const ExecutionLogEntry& entry,
                                      const ExecutionLogFilter& filter);

struct ExecutionLogContents {
    /// The oldest first.
    std::vector<ExecutionLogEntry> entries;
    /// There were older ones that match.
    bool is_cut{false};
    /// Lines that are no records, and files that are too large to be ours.
    std::size_t damaged{0};
};

/// The last entries that match, at most `max_entries`, of the text of a file. A last line without
/// its end is one that is being written, and is not looked at.
[[nodiscard]] BUSBAR_API ExecutionLogContents read_execution_log(std::string_view text,
                                                                 const ExecutionLogFilter& filter,
                                                                 std::size_t max_entries);

/// The same of all files in a folder, while they may be written: what is full in the meantime may
/// be there twice or not at all.
[[nodiscard]] BUSBAR_API Stored<ExecutionLogContents>
read_execution_log(Storage& storage, std::string_view folder, const ExecutionLogFilter& filter,
                   std::size_t max_entries);

/// The columns in which people see a log (seed 000, 7-2-2).
inline constexpr std::array<std::string_view, 6> execution_log_column_names{
    "Entry", "Date/Time", "Category", "Log Code", "Log Name", "Details"};
/// "7", "2017/10/17/14:52:50.878", "SERVER", "0005", "Run", "": of each column. Details are parted
/// by single spaces.
[[nodiscard]] BUSBAR_API std::array<std::string, 6>
execution_log_columns(const ExecutionLogEntry& entry);

} // namespace busbar::controller

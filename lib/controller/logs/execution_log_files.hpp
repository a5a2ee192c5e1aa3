#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/execution_log.hpp>

#include "line_file.hpp"

namespace busbar::controller::detail {

/// "OPCUA_ExecutionLog.log" and the others of W588, 7-1-5.
inline constexpr std::string_view current_log_name = "OPCUA_ExecutionLog.log";
inline constexpr std::string_view log_control_name = "OPCUA_ExecutionLog.fjc";

/// "OPCUA_ExecutionLog_20170724220915040.log".
[[nodiscard]] std::string full_log_name(DateTime time, TimeZone zone);
[[nodiscard]] bool is_full_log_name(std::string_view name);
/// Names of the full files in a folder, oldest first; none if the folder does not exist.
[[nodiscard]] Stored<std::vector<std::string>> full_logs(Storage& storage, std::string_view folder);

/// Maximum size of a file with so many records, with room for repaired lines.
[[nodiscard]] std::size_t max_log_size(std::size_t max_records);

/// The files of an execution log. Their contents tell where the log stands; the control file is
/// read only for what they do not tell. Not thread-safe; blocks on the medium.
class ExecutionLogFiles {
public:
    ExecutionLogFiles(Storage& storage, const WallClock& clock, const ExecutionLogOptions& options);

    struct Outcome {
        std::size_t saved{0}; // number of items saved, from the first on
        std::optional<StorageError> error;
    };
    /// Saves at least one of `items`, which must not be empty, or fails. After a failure the same
    /// items must be the first ones of the next call.
    [[nodiscard]] Outcome save(std::span<const WaitingLogItem> items);
    /// Writes the position of the log to the control file.
    [[nodiscard]] Stored<void> write_control();
    /// See ExecutionLog::begin_new_file().
    [[nodiscard]] Stored<void> complete();
    [[nodiscard]] Stored<void> clear();
    /// Closes the files: the next time another medium may be present.
    void close()
    {
        file_.close();
        control_.clear();
    }

private:
    [[nodiscard]] Stored<void> open();
    [[nodiscard]] Stored<void> find_serial();
    [[nodiscard]] Stored<std::optional<std::uint16_t>> serial_of_full_logs();
    [[nodiscard]] std::optional<std::uint16_t> read_control();
    [[nodiscard]] Stored<void> begin_new_file();
    [[nodiscard]] Stored<void> remove_oldest();
    [[nodiscard]] std::string records_of(std::span<const WaitingLogItem> items) const;

    Storage* storage_;
    const WallClock* clock_;
    ExecutionLogOptions options_;
    LineFile file_;
    std::optional<std::uint16_t> next_serial_; // empty until the medium has been read
    std::string control_; // last known content of the control file; empty if unknown
};

} // namespace busbar::controller::detail

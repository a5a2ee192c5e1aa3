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
/// The names of full files in a folder, the oldest first; none if there is no folder.
[[nodiscard]] Stored<std::vector<std::string>> full_logs(Storage& storage, std::string_view folder);

/// Bytes that a file of so many records may have, with some for lines that were mended.
[[nodiscard]] std::size_t max_log_size(std::size_t max_records);

/// The files of an execution log. Files tell where it stands; the control file is asked only for
/// what they do not say. One thread at a time; blocks on the medium.
class ExecutionLogFiles {
public:
    ExecutionLogFiles(Storage& storage, const WallClock& clock, const ExecutionLogOptions& options);

    struct Outcome {
        std::size_t saved{0}; // of the first ones
        std::optional<StorageError> error;
    };
    /// Saves at least one of `items`, which are not none, or fails. Those that were in a call that
    /// failed must be the first ones of the next call.
    [[nodiscard]] Outcome save(std::span<const WaitingLogItem> items);
    /// Writes down where the log stands.
    [[nodiscard]] Stored<void> write_control();
    [[nodiscard]] Stored<void> clear();
    /// Another medium may be there the next time.
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
    std::optional<std::uint16_t> next_serial_; // nothing: the medium has not been seen yet
    std::string control_; // what the control file is known to say; empty: not known
};

} // namespace busbar::controller::detail

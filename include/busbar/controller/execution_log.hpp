#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/controller/execution_log_record.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::controller {

namespace detail {
class ExecutionLogFiles;
class OncePerCertificate;

struct WaitingLogItem {
    DateTime time;
    TimeZone zone;
    ExecutionLogItem item;
};
} // namespace detail

/// Settings of the execution log (W588, 7-1-3). The embedder decides whether
/// there is a log at all: without this object there is none.
struct ExecutionLogOptions {
    /// Maximum number of files in the folder, 2 to 100. The oldest is removed before a new one is
    /// begun.
    std::size_t max_files{24};
    /// Records in one file; 100 to 65,536.
    std::size_t max_records{12'000};
    /// Maximum number of records that wait while the medium is away; at least 600 (manual of
    /// variables mode, 7-4-4). The default also has room for one Preparing with 10,000 variables;
    /// add as many as there are more. Each takes about 150 bytes, at most 300.
    std::size_t max_waiting{16'384};
    /// The folder on the medium (W588, 7-1-5).
    std::string folder{"packages/OPCUA_Server/ExecutionLog"};
    std::string system_folder{"packages/OPCUA_Server/System"};
};

/// The state of the medium as far as it is known without accessing it.
enum class LogMedium : std::uint8_t {
    In,
    Out,
    Unusable, // inserted, but its type or format is wrong
};

/// The execution log (W588, section 7): a LogSink that turns records into
/// lines, which wait in memory until a thread of the embedder writes them to a removable medium.
///
/// Passes everything on to the next sink, also records of its own: ExecutionLogLost when records
/// cannot be saved or are lost, once until ExecutionLogSaved reports that saving works again.
///
/// record() and write() format and queue; they do not wait for a medium. All other functions block
/// on the medium and may be called from any thread, except those that serve clients.
class BUSBAR_API ExecutionLog final : public LogSink {
public:
    /// Does not read or write yet. `medium`, `clock` (whose time and time zone are used in the
    /// records) and `next` must outlive the result. A problem names the option that is out of
    /// range.
    [[nodiscard]] static Configured<std::unique_ptr<ExecutionLog>>
    create(Storage& medium, const WallClock& clock, LogSink& next,
           ExecutionLogOptions options = {});
    ~ExecutionLog() override;

    void write(LogLevel level, std::string_view source, std::string_view text) override;
    void record(const Record& record) override;
    [[nodiscard]] bool wants(RecordKind kind) const override;

    /// Saves the waiting records. Call it several times a second; after an error, every few
    /// seconds. Records that were not saved keep waiting.
    [[nodiscard]] Stored<void> write_pending();
    /// Saves like write_pending before a power failure: records that still wait afterwards are
    /// reported as lost.
    [[nodiscard]] Stored<void> flush();

    /// Call it before files of the log are removed: saves the waiting records, so that they go with
    /// the files, and the next serial number, so that numbers go on without them. Unlike the others
    /// it may be called by the thread that serves clients, which the removal blocks anyway.
    [[nodiscard]] Stored<void> prepare_removal();

    /// Call it before the medium is taken out (W588, 7-4-3): saves the waiting
    /// records and does not use the medium until it is reported as inserted again.
    [[nodiscard]] Stored<void> release_medium();
    /// Reports that the medium was taken out, inserted, or cannot be used. While it is known to be
    /// out nothing is reported as lost until records are; at the start it is assumed to be in.
    void medium_changed(LogMedium medium);

    /// Saves the waiting records, if possible, and renames the file that is being written, as if it
    /// were full, unless it has no records. Returns with a file for the next records.
    [[nodiscard]] Stored<void> begin_new_file();
    /// Tells whether a file of this name in the folder is complete: the log never writes it again.
    [[nodiscard]] static bool is_complete_file(std::string_view name);

    /// Removes all files of the log. Serial numbers continue. After an error some files may remain.
    [[nodiscard]] Stored<void> clear();

    /// The number of waiting records.
    [[nodiscard]] std::size_t waiting() const;
    /// The number of records that were dropped for lack of room, since the start.
    [[nodiscard]] std::uint64_t lost() const;

private:
    ExecutionLog(Storage& medium, const WallClock& clock, LogSink& next,
                 ExecutionLogOptions options);

    [[nodiscard]] Stored<void> save_all();
    [[nodiscard]] std::optional<std::uint16_t> known_fault() const;
    void drop_front(std::size_t count);
    void tell_lost(std::uint16_t code);
    void tell_saved();

    const WallClock* clock_;
    LogSink* next_;
    ExecutionLogOptions options_;

    mutable std::mutex queue_mutex_; // guards the five below; never held while the medium is used
    std::deque<detail::WaitingLogItem> queue_;
    std::unique_ptr<detail::OncePerCertificate> once_;
    std::uint64_t lost_{0};
    bool has_overflowed_{false}; // and this has not been reported yet
    LogMedium medium_{LogMedium::In};

    std::mutex files_mutex_; // guards the two below
    std::unique_ptr<detail::ExecutionLogFiles> files_;
    bool is_told_{false}; // reported that records are not saved
};

} // namespace busbar::controller

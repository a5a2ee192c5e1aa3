#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

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

/// Settings of the execution log (seed 000, 7-1-3). Whether there is one at all is the embedder's:
/// no object, no log.
struct ExecutionLogOptions {
    /// In the folder at the same time; 2 to 100. The oldest one goes when a new one is due.
    std::size_t max_files{24};
    /// Of one file; 100 to 65,536.
    std::size_t max_records{12'000};
    /// Records that wait while the medium is away; at least 600 (seed 000, 7-4-4). The default also
    /// has room for one Preparing of 10,000 variables. Whoever publishes more adds as many. Each
    /// takes about 150 bytes, at most 300.
    std::size_t max_waiting{16'384};
    /// On the medium (seed 000, 7-1-5).
    std::string folder{"packages/OPCUA_Server/ExecutionLog"};
    std::string system_folder{"packages/OPCUA_Server/System"};
};

/// What is known of the medium without trying it.
enum class LogMedium : std::uint8_t {
    In,
    Out,
    Unusable, // in, but of a wrong type or format
};

/// The execution log of seed 000, section 7: a LogSink that turns records into lines, which wait in
/// memory until a thread of the embedder's writes them to a medium that may be pulled out.
///
/// Everything is passed on to the next sink, also what the log tells itself: ExecutionLogLost when
/// records cannot be saved or are lost, once until ExecutionLogSaved says that it works again.
///
/// record() and write() format and queue; they wait for no medium. Everything else blocks on the
/// medium and may be called from any thread, but from none that serves clients.
class BUSBAR_API ExecutionLog final : public LogSink {
public:
    /// Reads and writes nothing yet. `medium`, `clock` (its time and its zone stand in the records)
    /// and `next` must outlive the result. A problem names the option that is out of range.
    [[nodiscard]] static Configured<std::unique_ptr<ExecutionLog>>
    create(Storage& medium, const WallClock& clock, LogSink& next,
           ExecutionLogOptions options = {});
    ~ExecutionLog() override;

    void write(LogLevel level, std::string_view source, std::string_view text) override;
    void record(const Record& record) override;
    [[nodiscard]] bool wants(RecordKind kind) const override;

    /// Saves what waits. To be called some times a second; after an error in some seconds. What was
    /// not saved goes on waiting.
    [[nodiscard]] Stored<void> write_pending();
    /// The same before the power goes: what still waits afterwards is told as lost.
    [[nodiscard]] Stored<void> flush();

    /// Somebody is going to remove files of the log: saves what waits, so that it goes with them,
    /// and notes the next serial number, so that numbers go on without the files.
    [[nodiscard]] Stored<void> prepare_removal();

    /// Somebody is going to take the medium out (seed 000, 7-4-3): saves what waits and uses it no
    /// more until it is said to be in again.
    [[nodiscard]] Stored<void> release_medium();
    /// It was taken out, put in, or cannot be used. While it is known to be out nothing is told as
    /// lost before records are; at the start it counts as in.
    void medium_changed(LogMedium medium);

    /// Removes all files of the log. Serial numbers go on. After an error some may be left.
    [[nodiscard]] Stored<void> clear();

    /// Records that wait.
    [[nodiscard]] std::size_t waiting() const;
    /// Records that there was no room for, since the start.
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

    mutable std::mutex queue_mutex_; // of the five below; never held while the medium is used
    std::deque<detail::WaitingLogItem> queue_;
    std::unique_ptr<detail::OncePerCertificate> once_;
    std::uint64_t lost_{0};
    bool has_overflowed_{false}; // and nobody was told yet
    LogMedium medium_{LogMedium::In};

    std::mutex files_mutex_; // of the two below
    std::unique_ptr<detail::ExecutionLogFiles> files_;
    bool is_told_{false}; // that records are not saved
};

} // namespace busbar::controller

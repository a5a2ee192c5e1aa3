#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <busbar/controller/machine_event.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/record.hpp>
#include <busbar/core/storage.hpp>

namespace busbar::controller {

namespace detail {
class MachineEventFiles;
class MachineEventRules;
} // namespace detail

/// Is called for each event when it happens, on the thread that reported the record: like
/// LogSink::record, it must neither block nor report records itself.
class BUSBAR_API MachineEventListener {
public:
    MachineEventListener() = default;
    MachineEventListener(const MachineEventListener&) = delete;
    MachineEventListener& operator=(const MachineEventListener&) = delete;
    virtual ~MachineEventListener() = default;

    /// Called for each event that is recorded.
    virtual void happened(const MachineEvent& event) = 0;
    /// The errors in MachineEventLog::current_errors have changed; called after the event that
    /// added one, and also when one has ended, which is not an event.
    virtual void errors_changed() {}
};

/// The level that a user chose for an event.
struct EventLevelChoice {
    std::uint32_t code{0};
    EventLevel level{};
};

/// The place and the size of the event log.
struct MachineEventLogOptions {
    /// Maximum number of events, the oldest is dropped; 16 to 100,000.
    std::size_t max_entries{1'024};
    /// A folder of the storage.
    std::string folder{"events"};
    /// For events whose level a user may change (W588, 9-2-1).
    std::vector<EventLevelChoice> levels{};
};

/// The outputs of GetPLCError (W588, 9-1-1).
struct PlcError {
    EventLevel level; // PartialFault or MinorFault
    std::uint32_t code;

    friend bool operator==(const PlcError&, const PlcError&) = default;
};

/// The event log (W588, section 9): a LogSink that turns records into events,
/// keeps the last ones in a Storage and knows the current errors. Passes everything on to the next
/// sink.
///
/// record(), write() and the queries do not block on storage; load() and write_pending() do. Any
/// thread.
class BUSBAR_API MachineEventLog final : public LogSink {
public:
    /// Does not read or write yet. `storage`, `clock`, `next` and `listener`, which may be null,
    /// must outlive the result. A problem names the option.
    [[nodiscard]] static Configured<std::unique_ptr<MachineEventLog>>
    create(Storage& storage, const WallClock& clock, LogSink& next,
           MachineEventListener* listener = nullptr, MachineEventLogOptions options = {});
    ~MachineEventLog() override;

    void write(LogLevel level, std::string_view source, std::string_view text) override;
    void record(const Record& record) override;
    [[nodiscard]] bool wants(RecordKind kind) const override;

    /// Loads the events from before a restart; events that have happened since are appended. Call
    /// it once.
    [[nodiscard]] Stored<void> load();
    /// Saves new events, after load() if that has not succeeded yet.
    [[nodiscard]] Stored<void> write_pending();

    /// The oldest first.
    [[nodiscard]] std::vector<MachineEvent> events() const;
    /// The current errors, in the order of their occurrence.
    [[nodiscard]] std::vector<MachineEvent> current_errors() const;
    /// Returns the highest level among the current errors that are faults, and the highest code
    /// within it; nothing if there is no fault. PLC tasks may call it: it does not wait and does
    /// not allocate.
    [[nodiscard]] std::optional<PlcError> plc_error() const;

private:
    MachineEventLog(Storage& storage, const WallClock& clock, LogSink& next,
                    MachineEventListener* listener, MachineEventLogOptions options);

    [[nodiscard]] Stored<void> load_once();
    void keep(const MachineEvent& event);

    const WallClock* clock_;
    LogSink* next_;
    MachineEventListener* listener_;
    MachineEventLogOptions options_;

    mutable std::mutex mutex_; // guards the four below; never held while the storage is used
    std::unique_ptr<detail::MachineEventRules> rules_;
    std::deque<MachineEvent> events_;
    std::size_t unsaved_{0}; // the number of newest events not yet saved
    std::uint64_t last_number_{0};
    /// Level and code of plc_error() in one number; 0: none.
    std::atomic<std::uint64_t> plc_error_{0};
    static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

    std::mutex files_mutex_; // guards the two below
    std::unique_ptr<detail::MachineEventFiles> files_;
    bool is_loaded_{false};
};

} // namespace busbar::controller

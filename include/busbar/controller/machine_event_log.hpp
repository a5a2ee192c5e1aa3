#pragma once

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

/// Learns of each event when it happens, by the thread that told the record: as LogSink::record, it
/// must neither block nor tell anything in turn.
class BUSBAR_API MachineEventListener {
public:
    MachineEventListener() = default;
    MachineEventListener(const MachineEventListener&) = delete;
    MachineEventListener& operator=(const MachineEventListener&) = delete;
    virtual ~MachineEventListener() = default;

    virtual void happened(const MachineEvent& event) = 0;
    /// Other errors stand than before, which MachineEventLog::current_errors has; after the event
    /// that stands now, and also when one is over, which is no event.
    virtual void errors_changed() {}
};

struct EventLevelChoice {
    std::uint32_t code{0};
    EventLevel level{};
};

struct MachineEventLogOptions {
    /// Events that are kept, the oldest goes; 16 to 100,000.
    std::size_t max_entries{1'024};
    /// Of the storage.
    std::string folder{"events"};
    /// For events whose level a user may change (seed 000, 9-2-1).
    std::vector<EventLevelChoice> levels{};
};

/// What GetPLCError tells (seed 000, 9-1-1).
struct PlcError {
    EventLevel level; // PartialFault or MinorFault
    std::uint32_t code;

    friend bool operator==(const PlcError&, const PlcError&) = default;
};

/// The event log of seed 000, section 9: a LogSink that turns records into events, keeps the last
/// ones in a Storage and knows which errors stand. Everything is passed on to the next sink.
///
/// record(), write() and what is asked block on no storage; load() and write_pending() do. Any
/// thread.
class BUSBAR_API MachineEventLog final : public LogSink {
public:
    /// Reads and writes nothing yet. `storage`, `clock`, `next` and `listener`, which may be null,
    /// must outlive the result. A problem names the option.
    [[nodiscard]] static Configured<std::unique_ptr<MachineEventLog>>
    create(Storage& storage, const WallClock& clock, LogSink& next,
           MachineEventListener* listener = nullptr, MachineEventLogOptions options = {});
    ~MachineEventLog() override;

    void write(LogLevel level, std::string_view source, std::string_view text) override;
    void record(const Record& record) override;
    [[nodiscard]] bool wants(RecordKind kind) const override;

    /// Takes in what was kept before a restart; what has happened since comes behind it. Once.
    [[nodiscard]] Stored<void> load();
    /// Saves what is new, after load() if that has not succeeded yet.
    [[nodiscard]] Stored<void> write_pending();

    /// The oldest first.
    [[nodiscard]] std::vector<MachineEvent> events() const;
    /// Those that stand, in the order in which they came.
    [[nodiscard]] std::vector<MachineEvent> current_errors() const;
    /// Of the current errors that are faults the highest level, and in that the highest code;
    /// nothing if there is none.
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

    mutable std::mutex mutex_; // of the four below; never held while the storage is used
    std::unique_ptr<detail::MachineEventRules> rules_;
    std::deque<MachineEvent> events_;
    std::size_t unsaved_{0}; // the last ones
    std::uint64_t last_number_{0};

    std::mutex files_mutex_; // of the two below
    std::unique_ptr<detail::MachineEventFiles> files_;
    bool is_loaded_{false};
};

} // namespace busbar::controller

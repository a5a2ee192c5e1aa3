#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/controller/machine_settings.hpp>
#include <busbar/controller/machine_status.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>

/// When a controller's OPC UA server starts, stops and is reconfigured (manual of variables mode,
/// 4-1 and 4-2).
namespace busbar::controller {

namespace detail {
enum class LifePhase : std::uint8_t;
enum class LifeEvent : std::uint8_t;
enum class LifeAction : std::uint8_t;
} // namespace detail

/// The information that clients get before their connections end.
struct StopNotice {
    /// ServerStatus.ShutdownReason (Part 5, 12.10).
    std::string_view reason;
    /// EstimatedReturnTime; null if the server returns only after a restart.
    DateTime return_time{};
};

/// The functions of the program that LifeCycle needs. They are called from within its functions and
/// may call prepared() and its like at once or later, on the same thread.
class BUSBAR_API ServerOperator {
public:
    ServerOperator() = default;
    ServerOperator(const ServerOperator&) = delete;
    ServerOperator& operator=(const ServerOperator&) = delete;
    virtual ~ServerOperator() = default;

    /// After power-on or reset: reads the settings and sets up what is monitored. Answered by
    /// LifeCycle::initialized.
    virtual void initialize() = 0;
    /// Creates endpoints and nodes; listeners may exist already, but no client may connect yet.
    /// Answered by LifeCycle::prepared or preparation_failed with the same number. A later call
    /// supersedes this one.
    virtual void prepare(std::uint32_t number, const ServerSettings& settings) = 0;
    /// Prepares a server that runs and only has to change: in place if the program can do that,
    /// otherwise by another server. Listeners stay; clients whose connection has to end get
    /// `notice`.
    virtual void reconfigure(std::uint32_t number, const ServerSettings& settings,
                             const StopNotice& notice) = 0;
    /// Lets clients connect to the prepared server.
    virtual void run() = 0;
    /// Ends connections, notifies clients of the reason, gives up a preparation; listeners stay but
    /// accept no client. A prepare() or stop() follows.
    virtual void suspend(const StopNotice& notice) = 0;
    /// Ends everything, including listeners, and saves the execution log. Answered by
    /// LifeCycle::stopped when that is done, once for each call. A preparation requested meanwhile
    /// waits for it.
    virtual void stop(const StopNotice& notice) = 0;
    /// The program was edited online: publishes new variables in addition to the existing ones.
    virtual void add_variables() = 0;
    /// The medium of the execution log was inserted or taken out.
    virtual void medium_changed(bool is_in) = 0;
    /// Power is about to fail: saves now what can be saved.
    virtual void save_now() = 0;
};

/// The reason why a server could not be prepared.
enum class PreparationFailure : std::uint8_t {
    Settings, // "Configuration Error"
    Start,    // "Server Start Error": the port is in use, the address space cannot be made
    System,   // "OPC UA System Error": anything that no download can correct
};

/// The origin of an error of the controller.
enum class FaultOrigin : std::uint8_t { Elsewhere, OpcUaServer };

/// The answer to a request to shut the server down; the codes are those of an instruction (manual
/// of variables mode, A-2-4).
enum class ShutdownAnswer : std::uint16_t {
    Begun = 0,
    ShutDown = 0x5000, // or is shutting down
    Initializing = 0x5001,
    NotStarted = 0x5002,
};

/// The expected times from which clients' waiting time is estimated.
struct LifeCycleOptions {
    std::chrono::seconds download_time{60}; // also of a restore
    /// Used until a preparation has been measured.
    std::chrono::seconds preparation_time{10};
};

/// The states of 4-2-4 and the transitions between them, as a table. It has no threads and reads no
/// clock except for EstimatedReturnTime. Everything that only hardware or a runtime knows is
/// reported by calls.
///
/// Used by one thread, the server's. A call that does not fit the state does nothing.
class BUSBAR_API LifeCycle {
public:
    /// All arguments must outlive it. `log` gets the records ServerStarted to ServerSystemError.
    LifeCycle(ServerOperator& server, const WallClock& clock, LogSink& log,
              const LifeCycleOptions& options = {});

    // Calls for the machine.

    void power_on();
    /// A running server is shut down before (W588, 7-3-3).
    void reset();
    /// Reports that the power is about to fail.
    void power_going();
    /// Reports the mode that the machine is in from now on.
    void mode_changed(MachineMode mode) { mode_ = mode; }
    /// Reports that the medium of the execution log was inserted or removed.
    void medium_changed(bool is_in);
    // Faults are recorded as MachineFault. One that is not the server's does not stop it (manual of
    // variables mode, 4-1-4).

    /// The user program stops (W588, 9-1-2).
    void major_fault();
    /// A partial fault of the server is a system_error().
    void partial_fault(FaultOrigin origin);
    /// Minor faults that stop the server are reported by preparation_failed and system_error
    /// instead.
    void minor_fault(FaultOrigin origin);
    /// The CPU's watchdog has expired: everything stops.
    void watchdog();

    // Calls for its program and settings.

    /// A download replaces program and settings; until it is done no client is connected. Not
    /// before initialized().
    void download_begins();
    /// Passes the settings now in the controller, the old ones if the download failed. For a
    /// project without an OPC UA server pass ServerSettings{}; see also
    /// MachineMemory::clear_security.
    void download_done(const Configured<ServerSettings>& settings);
    /// Adds variables without a reconfiguration (W588, 4-2-5).
    void online_edit();
    void restore_begins();
    /// If restored, the server stays stopped until a restart, which reads the settings; otherwise
    /// it returns.
    void restore_done(bool is_restored);
    /// Bad_InvalidState in RUN (W588, 8-3). clear_done() is due only if there
    /// is no problem.
    [[nodiscard]] Configured<void> clear_begins();
    /// Reports the end of clearing, which may have failed.
    void clear_done(bool is_cleared);
    // These reconfigure (W588, 4-2-5).
    void address_changed();
    void certificate_renewed();
    void security_changed();

    /// Requested by a tool or an instruction.
    ShutdownAnswer shut_down(std::string_view reason);
    /// Reports a fatal error in the server (W588, 9-2-2, 44180000).
    void system_error(std::string_view text);

    // Answers of the ServerOperator.

    /// Passes the settings, or the reason why they cannot be read.
    void initialized(const Configured<ServerSettings>& settings);
    /// Reports that the server of this number can serve at this URL.
    void prepared(std::uint32_t number, std::string_view endpoint_url);
    /// Reports why there is no server.
    void preparation_failed(std::uint32_t number, PreparationFailure failure,
                            std::string_view text);
    void stopped();

    // The present state.

    [[nodiscard]] OperatingStatus operating_status() const;
    [[nodiscard]] ServedClients served_clients() const;
    /// In Halt error: "Configuration Error", "Server Start Error" or "OPC UA System Error", and
    /// more details; otherwise empty.
    [[nodiscard]] std::string halt_reason() const;
    /// False after a fault that stops the user program, until a restart.
    [[nodiscard]] bool has_program_going() const { return has_program_going_; }
    /// Includes the end point as it is published.
    [[nodiscard]] MachineStatus status(const ConnectionCounts& counts) const;
    [[nodiscard]] MachineMode mode() const { return mode_; }
    /// Returns whether settings, a restore, a cleared memory or a fault wait for power-on or a
    /// reset.
    [[nodiscard]] bool is_restart_due() const { return !restart_reason().empty(); }
    /// "the controller's memory was restored or cleared"; empty if no restart is due.
    [[nodiscard]] std::string_view restart_reason() const;
    /// The shutdown is completed: power may be turned off (W588, 4-2-4).
    [[nodiscard]] bool has_stopped() const;
    /// Returns the answer that an instruction would get now; Begun if it would begin a shutdown.
    [[nodiscard]] ShutdownAnswer shutdown_answer() const;

private:
    /// Does what the table has for an event. `why` is for clients or for the log.
    void handle(detail::LifeEvent event, std::string_view why = {});
    /// Records the table's causes that are not the server's.
    void tell_cause(detail::LifeEvent event, std::string_view where);
    void tell_record(RecordKind kind, std::string_view why);
    void act(detail::LifeAction action, detail::LifeEvent event, std::string_view why);
    void begin_preparation();
    void run();
    [[nodiscard]] DateTime return_time(std::chrono::seconds more) const;

    ServerOperator* server_;
    const WallClock* clock_;
    LogSink* log_;
    LifeCycleOptions options_;
    detail::LifePhase phase_{};
    ServerSettings settings_{}; // those in the controller
    /// The memory no longer holds what the controller started with.
    bool is_replaced_{false};
    bool is_edited_{false}; // edited while it was prepared
    std::size_t stops_{0};  // not answered yet
    MachineMode mode_{MachineMode::Program};
    std::uint32_t preparation_{0};
    DateTime preparation_began_{};
    std::chrono::seconds preparation_time_;
    std::string endpoint_url_;
    /// The reason for ServerHalted, and more details.
    std::string_view halt_reason_;
    std::string halt_details_;
    bool has_program_going_{true};
};

} // namespace busbar::controller

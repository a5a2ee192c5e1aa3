#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/controller/machine_settings.hpp>
#include <busbar/controller/machine_status.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>

/// When a controller's OPC UA server starts, stops and is reconfigured (seed 000, 4-1 and 4-2).
namespace busbar::controller {

namespace detail {
enum class LifePhase : std::uint8_t;
enum class LifeEvent : std::uint8_t;
enum class LifeAction : std::uint8_t;
} // namespace detail

/// What clients are told before their connections end.
struct StopNotice {
    /// ServerStatus.ShutdownReason (Part 5, 12.10).
    std::string_view reason;
    /// EstimatedReturnTime; null if the server comes back by a restart only.
    DateTime return_time{};
};

/// What a program does for LifeCycle. Called from within its functions; may call prepared() and the
/// like at once or later, on the same thread.
class BUSBAR_API ServerOperator {
public:
    ServerOperator() = default;
    ServerOperator(const ServerOperator&) = delete;
    ServerOperator& operator=(const ServerOperator&) = delete;
    virtual ~ServerOperator() = default;

    /// Power came, or a reset: read the settings and set up what is monitored. Answered by
    /// LifeCycle::initialized.
    virtual void initialize() = 0;
    /// Make endpoints and nodes, behind listeners that may be there already; nobody may come in
    /// yet. Answered by LifeCycle::prepared or preparation_failed with the same number. A later
    /// call means that this one is not wanted any more.
    virtual void prepare(std::uint32_t number, const ServerSettings& settings) = 0;
    /// The same for a server that runs and only has to change: in place where the program can, else
    /// by another server. Listeners stay; clients whose connection has to end are told `notice`.
    virtual void reconfigure(std::uint32_t number, const ServerSettings& settings,
                             const StopNotice& notice) = 0;
    /// What was prepared lets clients in.
    virtual void run() = 0;
    /// End connections, tell clients why, give up what is being prepared; listeners stay and let
    /// nobody in. A prepare() or stop() follows.
    virtual void suspend(const StopNotice& notice) = 0;
    /// End everything, listeners too, and save the execution log. Answered by LifeCycle::stopped
    /// when that is done, once for each call. What is to be prepared meanwhile waits for it.
    virtual void stop(const StopNotice& notice) = 0;
    /// The program was edited online: publish what is new besides what there is.
    virtual void add_variables() = 0;
    /// The medium of the execution log came or went.
    virtual void medium_changed(bool is_in) = 0;
    /// Power is going: save now what can be saved.
    virtual void save_now() = 0;
};

/// Why a server could not be prepared.
enum class PreparationFailure : std::uint8_t {
    Settings, // "Configuration Error"
    Start,    // "Server Start Error": the port is in use, the address space cannot be made
    System,   // "OPC UA System Error": anything that no download can mend
};

/// Whose an error of the controller is.
enum class FaultOrigin : std::uint8_t { Elsewhere, OpcUaServer };

/// What a request to shut the server down comes to; the codes are those of an instruction
/// (seed 000, A-2-4).
enum class ShutdownAnswer : std::uint16_t {
    Begun = 0,
    ShutDown = 0x5000, // or shutting down
    Initializing = 0x5001,
    NotStarted = 0x5002,
};

/// How long clients are told to wait.
struct LifeCycleOptions {
    std::chrono::seconds download_time{60}; // or a restore
    /// Until a preparation has been measured.
    std::chrono::seconds preparation_time{10};
};

/// The states of 4-2-4 and what leads from one to another: a table. It has no threads and asks no
/// clock but for EstimatedReturnTime. Everything that only hardware or a runtime knows is a call.
///
/// One thread, the server's. A call that does not fit the state does nothing.
class BUSBAR_API LifeCycle {
public:
    /// All must outlive it. `log` gets the records ServerStarted to ServerSystemError.
    LifeCycle(ServerOperator& server, const WallClock& clock, LogSink& log,
              const LifeCycleOptions& options = {});

    // Of the machine.

    void power_on();
    /// A server that runs is shut down before (seed 000, 7-3-3).
    void reset();
    void power_going();
    void mode_changed(MachineMode mode) { mode_ = mode; }
    void medium_changed(bool is_in);
    // Faults are told as MachineFault. One that is not the server's does not stop it (seed 000,
    // 4-1-4).

    /// The user program stops (seed 000, 9-1-2).
    void major_fault();
    /// One of the server's is a system_error().
    void partial_fault(FaultOrigin origin);
    /// Those of the server's that stop it come by preparation_failed and system_error.
    void minor_fault(FaultOrigin origin);
    /// The CPU's watchdog: everything stops.
    void watchdog();

    // Of its program and settings.

    /// A download replaces program and settings. In between clients are out. Not before
    /// initialized().
    void download_begins();
    /// The settings that are in the controller now, old ones if it failed. A project that knows no
    /// OPC UA server has ServerSettings{}; see also MachineMemory::clear_security.
    void download_done(const Configured<ServerSettings>& settings);
    /// Adds variables without a reconfiguration (seed 000, 4-2-5).
    void online_edit();
    void restore_begins();
    /// Restored: the server stays out until a restart, which reads the settings. Not restored: it
    /// comes back.
    void restore_done(bool is_restored);
    /// Bad_InvalidState in RUN (seed 000, 8-3). clear_done() is due only if there is no problem.
    [[nodiscard]] Configured<void> clear_begins();
    void clear_done(bool is_cleared);
    // These reconfigure (seed 000, 4-2-5).
    void address_changed();
    void certificate_renewed();
    void security_changed();

    /// From a tool or an instruction.
    ShutdownAnswer shut_down(std::string_view reason);
    /// A fatal error was found in the server (seed 000, 9-2-2, 44180000).
    void system_error(std::string_view text);

    // Answers of the ServerOperator.

    /// The settings, or why they cannot be read.
    void initialized(const Configured<ServerSettings>& settings);
    void prepared(std::uint32_t number, std::string_view endpoint_url);
    void preparation_failed(std::uint32_t number, PreparationFailure failure,
                            std::string_view text);
    void stopped();

    // What there is.

    [[nodiscard]] OperatingStatus operating_status() const;
    [[nodiscard]] ServedClients served_clients() const;
    /// In Halt error: "Configuration Error", "Server Start Error" or "OPC UA System Error", and
    /// more about it; else empty.
    [[nodiscard]] std::string halt_reason() const;
    /// False after a fault that stops the user program, until a restart.
    [[nodiscard]] bool has_program_going() const { return has_program_going_; }
    /// With the end point as it is published.
    [[nodiscard]] MachineStatus status(const ConnectionCounts& counts) const;
    [[nodiscard]] MachineMode mode() const { return mode_; }
    /// Settings, a restore or a cleared memory wait for power or a reset, or a fault does.
    [[nodiscard]] bool is_restart_due() const { return !restart_reason().empty(); }
    /// "the controller's memory was restored or cleared"; empty if no restart is due.
    [[nodiscard]] std::string_view restart_reason() const;
    /// The shutdown is completed: power may go (seed 000, 4-2-4).
    [[nodiscard]] bool has_stopped() const;
    /// Of an instruction executed now; Begun where it would be.
    [[nodiscard]] ShutdownAnswer shutdown_answer() const;

private:
    /// What the table says of an event. `why` is for clients or for the log.
    void handle(detail::LifeEvent event, std::string_view why = {});
    /// The table's causes: what is not the server's.
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
    /// What the controller started with is not what is in its memory.
    bool is_replaced_{false};
    bool is_edited_{false}; // while it was prepared
    std::size_t stops_{0};  // not answered yet
    MachineMode mode_{MachineMode::Program};
    std::uint32_t preparation_{0};
    DateTime preparation_began_{};
    std::chrono::seconds preparation_time_;
    std::string endpoint_url_;
    /// Why it halts, for ServerHalted, and more about it.
    std::string_view halt_reason_;
    std::string halt_details_;
    bool has_program_going_{true};
};

} // namespace busbar::controller

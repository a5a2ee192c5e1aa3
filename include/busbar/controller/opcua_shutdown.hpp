#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>

namespace busbar::controller {

class LifeCycle;
class MachineEventLog;
struct PlcError;

/// The system-defined variable that says whether a restore brings the security profile back (W588,
/// Programs use it without declaring it.
inline constexpr std::string_view restore_target_variable = "_Card1RestoreCmdTargetOpcuaSPF";

/// Connects instructions of PLC tasks with the server's thread: a fixed number of places, each
/// taken by one instruction from its start to its end. Neither side ever waits for the other.
class BUSBAR_API InstructionDesk {
public:
    /// The maximum number of OPC UA instructions executed at the same time
    /// (W588, A-2-4).
    static constexpr std::size_t places = 32;
    /// The error code of an instruction beyond that number.
    static constexpr std::uint16_t too_many = 0x041D;

    InstructionDesk() = default;
    InstructionDesk(const InstructionDesk&) = delete;
    InstructionDesk& operator=(const InstructionDesk&) = delete;

    /// Call it on the server's thread, every few milliseconds and when LifeCycle changes: shuts the
    /// server down if an instruction requests it, and reports the progress to instructions. Errors
    /// are recorded as InstructionFailed.
    void serve(LifeCycle& life, LogSink& log);

    /// The log that GetPLCError asks, before the first scan; must outlive the last one.
    void use(const MachineEventLog& errors) { errors_ = &errors; }
    /// Returns the result of GetPLCError (W588, 9-1-1); nothing without a log. Any thread.
    [[nodiscard]] std::optional<PlcError> plc_error() const;

    /// The value of restore_target_variable, FALSE when a program begins. Any thread, also within a
    /// scan.
    [[nodiscard]] bool restores_security_profile() const { return restores_profile_.load(); }
    /// Sets it. Any thread, too.
    void set_restores_security_profile(bool value) { restores_profile_.store(value); }

private:
    friend class OpcuaShutdown;

    /// The state of a place: free, a request, one that is carried out, completed, or failed with an
    /// error code in the lower half.
    enum : std::uint32_t { Free, Requested, Accepted, Finished, Failed = 0x1'0000 };
    static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

    /// Returns `places` if none is free.
    [[nodiscard]] std::size_t take_place();

    std::array<std::atomic<std::uint32_t>, places> states_{};
    /// The number of instructions that found no place, and how many of them were reported.
    std::atomic<std::uint32_t> turned_away_{0};
    std::uint32_t told_{0};
    const MachineEventLog* errors_{nullptr};
    std::atomic<bool> restores_profile_{false};
    static_assert(std::atomic<bool>::is_always_lock_free);
};

/// The function block OPCUA_Shutdown (W588, A-2-1): requests the end of the OPC
/// UA functions so that power can be turned off. An instance belongs to one PLC task, which calls
/// it in each scan; calls take a bounded number of steps, whatever the server does.
class BUSBAR_API OpcuaShutdown {
public:
    /// `desk` must outlive this object.
    explicit OpcuaShutdown(InstructionDesk& desk) : desk_{&desk} {}
    OpcuaShutdown(const OpcuaShutdown&) = delete;
    OpcuaShutdown& operator=(const OpcuaShutdown&) = delete;
    /// A shutdown that was requested continues.
    ~OpcuaShutdown();

    /// Starts when Execute changes to TRUE, and then continues to its end regardless of Execute.
    /// Outputs are kept while Execute is TRUE, and at least for the call that finds the end.
    void operator()(bool execute);

    [[nodiscard]] bool done() const { return is_done_; }
    [[nodiscard]] bool busy() const { return place_ != InstructionDesk::places; }
    [[nodiscard]] bool error() const { return error_id_ != 0; }
    /// Returns 16#041D, 16#5000, 16#5001 or 16#5002; 0 without an error.
    [[nodiscard]] std::uint16_t error_id() const { return error_id_; }

private:
    void start();
    void look();

    InstructionDesk* desk_;
    std::size_t place_{InstructionDesk::places};
    bool was_executed_{false};
    bool is_done_{false};
    std::uint16_t error_id_{0};
};

} // namespace busbar::controller

#pragma once

#include <cstdint>
#include <memory>

#include <busbar/controller/opcua_shutdown.hpp>
#include <busbar/controller/plc_config.hpp>

#include "plc_target.hpp"

namespace busbar::controller::detail {

/// Runs one program on one variable.
class PlcStep {
public:
    /// True if a program of this kind can work on variables of this type.
    [[nodiscard]] static bool accepts(PlcProgramKind kind, BuiltInType type);

    /// The config's program must have been checked. Two kinds have a `source`: for Copy it has the
    /// same type, as many elements and none of them larger; for programs that may_set() it is the
    /// variable in `sets`.
    PlcStep(const PlcProgram& program, const PlcTarget& target, const PlcTarget& source = {});

    /// True if a program of this kind may have PlcProgram::sets.
    [[nodiscard]] static bool may_set(PlcProgramKind kind);
    /// Sets the desk of an instruction; must be called before the first run(), and the desk must
    /// outlive this object.
    void use(InstructionDesk& desk)
    {
        desk_ = &desk;
        shutdown_ = std::make_unique<OpcuaShutdown>(desk);
    }

    void run(Duration elapsed) { run_(*this, elapsed); }
    /// True for a program of kind Increment.
    [[nodiscard]] bool is_counter() const { return is_counter_; }
    /// Resets a counter's target to zeros.
    void reset();

private:
    using Run = void (*)(PlcStep&, Duration);
    using Set = void (*)(const PlcTarget& target, double value);

    /// Number of periods of the program that have ended by now.
    [[nodiscard]] std::uint64_t firings(Duration elapsed);
    template <typename T>
    static void increment(PlcStep& step, Duration elapsed);
    template <typename T>
    static void sine(PlcStep& step, Duration elapsed);
    static void toggle(PlcStep& step, Duration elapsed);
    static void copy(PlcStep& step, Duration elapsed);
    template <typename T>
    static void acknowledge(PlcStep& step, Duration elapsed);
    static void shut_down(PlcStep& step, Duration elapsed);
    static void get_plc_error(PlcStep& step, Duration elapsed);
    [[nodiscard]] static Run choose(PlcProgramKind kind, BuiltInType type);

    Run run_;
    /// Null if nothing is set.
    Set set_{nullptr};
    /// Sets the target of a PlcError.
    Set answer_{nullptr};
    bool is_counter_;
    PlcTarget target_;
    PlcTarget source_;
    Duration period_;
    /// Time since the period began.
    Duration since_{0};
    double amplitude_;
    double offset_;
    double to_;
    InstructionDesk* desk_{nullptr};
    std::unique_ptr<OpcuaShutdown> shutdown_;
};

/// Waits for one event to happen.
class PlcWatch {
public:
    /// True if a variable of this type can be watched.
    [[nodiscard]] static bool accepts(BuiltInType type);

    /// Watches the first element of the variable, whose type must be accepted.
    PlcWatch(const PlcTarget& variable, double limit);

    /// True if the event occurs; call it once in each scan. A condition that was already true when
    /// the PLC started is not an event.
    [[nodiscard]] bool occurs();

private:
    using IsAbove = bool (*)(const PlcWatch&);

    template <typename T>
    static bool is_above(const PlcWatch& watch);
    static bool is_true(const PlcWatch& watch);
    [[nodiscard]] static IsAbove choose(BuiltInType type);

    IsAbove is_above_;
    PlcTarget variable_;
    double limit_;
    bool was_above_{true};
};

} // namespace busbar::controller::detail

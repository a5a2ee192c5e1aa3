#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include <busbar/controller/plc.hpp>
#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::backend {
class LabelBackend;
}

namespace busbar::controller {
enum class MachineMode : std::uint8_t;
struct PlcError;
struct ProgramAddition;
} // namespace busbar::controller

namespace busbar::product {

/// What only a controller's hardware and firmware know (seed 000, 4-1-4 and 9-2).
enum class HardwareEvent : std::uint8_t {
    MajorFault,
    PartialFault,
    PartialServerFault, // of the OPC UA server
    MinorFault,
    MinorServerFault,
    Watchdog,
    MediumOut, // somebody is going to take it: its power switch was pressed
    MediumIn,
};

/// What a runtime has of the controller that it is part of. Any thread; nothing waits.
class BUSBAR_API RuntimeHost {
public:
    RuntimeHost() = default;
    RuntimeHost(const RuntimeHost&) = delete;
    RuntimeHost& operator=(const RuntimeHost&) = delete;

    /// The server follows soon.
    virtual void happen(HardwareEvent event) = 0;
    /// Power is going: what can be saved is saved soon.
    virtual void power_going() = 0;
    /// The program's file is another one: soon it is edited online or downloaded, or the log says
    /// why not. As SIGHUP does.
    virtual void reload() = 0;
    /// Somebody turned the mode switch. Soon the controller is in that mode, or the log says why
    /// not; Runtime::mode_changed tells.
    virtual void switch_mode(controller::MachineMode mode) = 0;
    /// What the instruction GetPLCError tells (seed 000, 9-1-1); see
    /// controller/machine_event_log.hpp.
    [[nodiscard]] virtual std::optional<controller::PlcError> plc_error() const = 0;

protected:
    ~RuntimeHost() = default;
};

/// A program while a runtime runs it, with its PLC: scan() is what moves the variables. Downloads
/// make another one, which is there before this one stops and scans after that.
class BUSBAR_API LoadedProgram : public controller::PlcLogic {
public:
    /// A scan of the PLC. Gives its time and how long the one before is ago; by one thread at a
    /// time, which need not wait for it.
    using Cycle = std::function<void(DateTime now, Duration elapsed)>;

    /// From now on until stop() returns, a task of the runtime's own calls `cycle`, which calls
    /// scan(): true. False, as here: the controller's own task does it, as often as the
    /// configuration says. On the server's thread, as the next two.
    [[nodiscard]] virtual bool start([[maybe_unused]] const Cycle& cycle) { return false; }
    /// Waits for a scan that runs. start() may follow.
    virtual void stop() {}
    /// The program was edited online (seed 000, 3-3-2): variables that were added are in the scans
    /// from the next one on, those that were removed nobody sees any more, and their memory stays
    /// in use. The scans go on meanwhile.
    virtual void edited([[maybe_unused]] const controller::ProgramAddition& change) {}
};

/// What a PLC maker implements to have his PLC in the controller, instead of the simulated one of
/// busbar-controller.
///
/// On the server's thread, but for what memory_of() gives and for scans.
class BUSBAR_API Runtime {
public:
    Runtime() = default;
    Runtime(const Runtime&) = delete;
    Runtime& operator=(const Runtime&) = delete;
    virtual ~Runtime() = default;

    /// First, and again when the controller starts anew: `host` is there until end().
    virtual void begin([[maybe_unused]] RuntimeHost& host) {}
    virtual void end() {}

    /// Where the runtime has a variable of a program that load() is about to be asked for, as
    /// server::ImageVariable::runtime says; nothing, as here: it lies in the PLC's image. What is
    /// given lives as long as the loaded program.
    [[nodiscard]] virtual std::span<std::byte>
    memory_of([[maybe_unused]] const controller::GlobalVariable& variable)
    {
        return {};
    }
    /// Makes a program ready to run, while the one before it may still run. `plc` has its variables
    /// and outlives the result; `program` is null for variables of the configuration itself. The
    /// problem refuses the start or the download, of which nothing is left then.
    [[nodiscard]] virtual Configured<std::unique_ptr<LoadedProgram>>
    load(controller::Plc& plc, const controller::Program* program) = 0;

    /// The controller is in this mode: before a loaded program starts, and when it changes, by whom
    /// ever. Whether programs run in PROGRAM is the runtime's.
    virtual void mode_changed([[maybe_unused]] controller::MachineMode mode) {}
    /// Labels for a project of model mode to be mapped to; null, as here: there are none, and a
    /// project is refused.
    [[nodiscard]] virtual std::shared_ptr<backend::LabelBackend> labels() { return nullptr; }
    /// Whether the configuration may say what the PLC does ([[plc.program]]) and clients may play
    /// its hardware: in simulations only.
    [[nodiscard]] virtual bool is_simulated() const { return false; }
};

} // namespace busbar::product

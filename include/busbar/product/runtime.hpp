#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>

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

/// Events that only a controller's hardware and firmware know (W588, 4-1-4 and
/// 9-2).
enum class HardwareEvent : std::uint8_t {
    MajorFault,
    PartialFault,
    PartialServerFault, // of the OPC UA server
    MinorFault,
    MinorServerFault,
    Watchdog,
    MediumOut, // it is going to be removed: its power switch was pressed
    MediumIn,
    MediumWorn, // it is close to the end of its life (7-4-5)
};

/// The storage medium of a runtime, on which the execution log is written (W588, 7-4): a memory
/// card, for example. The runtime reports each change of its state, also before the controller
/// starts; the controller looks several times a second, as it does at its own folder. Any thread.
class StorageMedium {
public:
    /// The state of the medium, as the runtime reports it.
    enum class State : std::uint8_t {
        Usable,    // as far as its folder is
        Away,      // not inserted: what is to be written waits for it
        Full,      // nothing more can be written
        Protected, // nothing can be changed
    };

    [[nodiscard]] State state() const
    {
        const std::lock_guard lock{mutex_};
        return state_;
    }
    /// Reports what can be done with the medium from now on; from any thread.
    void set(State state)
    {
        const std::lock_guard lock{mutex_};
        state_ = state;
    }
    /// Returns the folder of its files; empty, as at first, for that of the configuration.
    [[nodiscard]] std::string folder() const
    {
        const std::lock_guard lock{mutex_};
        return folder_;
    }
    /// Changes that folder from now on.
    void lie_in(std::string folder)
    {
        const std::lock_guard lock{mutex_};
        folder_ = std::move(folder);
    }

private:
    mutable std::mutex mutex_;
    State state_{State::Usable};
    std::string folder_;
};

/// The functions of the controller for its runtime. Called from any thread; none waits.
class BUSBAR_API RuntimeHost {
public:
    RuntimeHost() = default;
    RuntimeHost(const RuntimeHost&) = delete;
    RuntimeHost& operator=(const RuntimeHost&) = delete;

    /// Reports an event; the server reacts soon, if [machine] gives it a life cycle.
    virtual void happen(HardwareEvent event) = 0;
    /// Power is failing: save what can be saved soon.
    virtual void power_going() = 0;
    /// The program's file has changed: it is soon edited online or downloaded, or the log says why
    /// not. Like SIGHUP.
    virtual void reload() = 0;
    /// The mode switch was turned. Soon the controller is in this mode, or the log says why not;
    /// Runtime::mode_changed reports it.
    virtual void switch_mode(controller::MachineMode mode) = 0;
    /// The result of the instruction GetPLCError (W588, 9-1-1), also for the
    /// scan of a PLC; see
    /// controller/machine_event_log.hpp.
    [[nodiscard]] virtual std::optional<controller::PlcError> plc_error() const = 0;

protected:
    ~RuntimeHost() = default;
};

/// A program that a runtime runs, with its PLC: scan() moves the variables. A download creates
/// another one, which exists before this one stops and scans after that.
class BUSBAR_API LoadedProgram : public controller::PlcLogic {
public:
    /// Performs a scan of the PLC, with its time and the time since the previous one; called by one
    /// thread at a time, which need not wait for it.
    using Cycle = std::function<void(DateTime now, Duration elapsed)>;

    /// Returns true if a task of the runtime calls `cycle`, which calls scan(), from now on until
    /// stop() returns. False, the default, if the controller's own task shall do it, as often as
    /// the configuration says. Called on the server's thread, like the next two.
    [[nodiscard]] virtual bool start([[maybe_unused]] const Cycle& cycle) { return false; }
    /// Waits for a running scan. start() may follow.
    virtual void stop() {}
    /// The program was edited online (W588, 3-3-2): added variables are in the
    /// scans from the next one on, removed ones are not visible any more, and their memory stays in
    /// use. Scans continue meanwhile.
    virtual void edited([[maybe_unused]] const controller::ProgramAddition& change) {}
};

/// The interface that a PLC maker implements to use his PLC in the controller, instead of the
/// simulated one of busbar-controller.
///
/// Called on the server's thread, except for load(), the memory of memory_of() and scans.
class BUSBAR_API Runtime {
public:
    Runtime() = default;
    Runtime(const Runtime&) = delete;
    Runtime& operator=(const Runtime&) = delete;
    virtual ~Runtime() = default;

    /// Called first, and again when the controller restarts: `host` is valid until end().
    virtual void begin([[maybe_unused]] RuntimeHost& host) {}
    virtual void end() {}

    /// Returns the memory of a variable of a program that is about to be loaded, as for
    /// server::ImageVariable::runtime; empty, the default, if it is in the PLC's image. It must
    /// live as long as the loaded program.
    [[nodiscard]] virtual std::span<std::byte>
    memory_of([[maybe_unused]] const controller::GlobalVariable& variable)
    {
        return {};
    }
    /// Makes a program ready to run, while the previous one may still run. `plc` has its variables
    /// and outlives the result; `program` is null for variables of the configuration itself. The
    /// problem refuses the start or the download, which then has no effect; nor has it, and the
    /// result ends without having started, if settings change meanwhile: the program is loaded
    /// again. Called on a thread of its own, one at a time, beside the server's: it may take long.
    [[nodiscard]] virtual Configured<std::unique_ptr<LoadedProgram>>
    load(controller::Plc& plc, const controller::Program* program) = 0;

    /// The controller is in this mode: called before a loaded program starts, and for any change.
    /// The runtime decides whether programs run in PROGRAM.
    virtual void mode_changed([[maybe_unused]] controller::MachineMode mode) {}
    /// Returns the labels that a project of model mode is mapped to; null, the default, if there
    /// are none, and a project is refused.
    [[nodiscard]] virtual std::shared_ptr<backend::LabelBackend> labels() { return nullptr; }
    /// Returns the runtime's storage medium, which must live as long as the runtime. Null, the
    /// default: the medium is the folder of the configuration, and the file system tells its state.
    /// A pressed power switch, before the medium is taken out, is told by RuntimeHost::happen.
    [[nodiscard]] virtual StorageMedium* medium() { return nullptr; }
    /// Returns whether the configuration may define the PLC's behaviour ([[plc.program]]) and
    /// clients may operate its hardware: only in simulations.
    [[nodiscard]] virtual bool is_simulated() const { return false; }
};

} // namespace busbar::product

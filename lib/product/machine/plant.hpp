#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <busbar/controller/checked_program.hpp>
#include <busbar/controller/plc.hpp>
#include <busbar/controller/plc_events.hpp>
#include <busbar/product/runtime.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/server/process_image.hpp>

#include "machine_program.hpp"
#include "product/configuration/config.hpp"
#include "simulated_runtime.hpp"

namespace busbar::product {

/// The PLC with the program that a runtime runs in it, and what serves it. Must outlive the server
/// that it is published in. On the server's thread, but for publish(), load() and raise().
class Plant {
public:
    /// Asks the runtime for the memory of its variables. Throws ConfigError. Both must outlive this
    /// object.
    Plant(const ControllerConfig& config, Runtime& runtime);

    /// Adds the PLC's variables, which may be those of a machine's program, its events and Methods,
    /// and information models beside them. `machine_log` is there if the configuration has a
    /// program, and must outlive it. `sources` has the models. `hardware` learns what clients tell
    /// of it. Once, on any thread; throws ConfigError.
    void publish(server::Server& server, SourceFiles& sources, LogSink& log,
                 const controller::MachineEventLog* machine_log,
                 std::function<void(HardwareEvent)> hardware);
    /// Lets the runtime load the program, after publish(), on the same thread. Throws ConfigError.
    void load();
    /// Drops the runtime's program while nothing scans, so that a Plant can be destroyed on another
    /// thread.
    void unload() { loaded_.reset(); }
    /// Keeps what clients write in `log`, which must outlive this object, before they are answered.
    /// Call it after publish() and before the server is served.
    void keep_writes(server::ImageWriteLog& log) { source_->keep_writes(&log); }
    /// Valid after publish(), but not with a program of labels.
    [[nodiscard]] controller::Plc& plc() { return *plc_; }
    [[nodiscard]] const controller::Plc& plc() const { return *plc_; }
    /// Null for none.
    [[nodiscard]] MachineProgram* program() { return program_ ? &*program_ : nullptr; }
    [[nodiscard]] const MachineProgram* program() const { return program_ ? &*program_ : nullptr; }
    /// Number of variables that clients see.
    [[nodiscard]] std::size_t visible_variables() const
    {
        if (program_) {
            return program_->publication().published().size();
        }
        return plc_ != nullptr ? plc_->variables().size() : 0;
    }
    /// Raises the events of a scan, on the thread that scans.
    void raise(DateTime time) const { events_->raise(time); }
    /// The runtime's program; valid after load(), but not with a program of labels.
    [[nodiscard]] LoadedProgram& loaded() { return *loaded_; }

private:
    /// Returns memory that was requested before publish(), or asks the runtime in an online edit.
    [[nodiscard]] std::span<std::byte> memory_of(const controller::GlobalVariable& variable);

    const ControllerConfig& config_;
    Runtime& runtime_;
    bool plays_hardware_;
    /// The runtime's medium; null if it has none.
    StorageMedium* medium_;
    /// The runtime's memory of the variables of its first program, in their order.
    std::vector<std::span<std::byte>> memory_;
    std::shared_ptr<const controller::CheckedProgram> asked_;
    std::optional<MachineProgram> program_;
    std::unique_ptr<controller::Plc> plc_;
    std::unique_ptr<LoadedProgram> loaded_;
    std::optional<server::ImageSource> source_;
    server::MethodTable methods_;
    std::optional<controller::PlcEvents> events_;
};

} // namespace busbar::product

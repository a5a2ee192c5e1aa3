#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <busbar/controller/machine_error_nodes.hpp>
#include <busbar/controller/machine_event_log.hpp>
#include <busbar/controller/machine_event_raiser.hpp>
#include <busbar/controller/machine_nodes.hpp>
#include <busbar/controller/plc.hpp>
#include <busbar/controller/published_program.hpp>
#include <busbar/server/server.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The name of a machine's folder.
[[nodiscard]] const std::string& controller_name(const ControllerConfig& config);

/// Shows a machine's event log to the clients of one server: events when they happen, and the
/// present errors. Thread-safe.
class MachineView final : public controller::MachineEventListener {
public:
    /// Connects it, once, on the server's thread; see MachineEventRaiser and MachineErrorNodes.
    [[nodiscard]] Result<void> attach(server::Server& server, const controller::MachineNodes& nodes,
                                      const controller::MachineEventLog& log)
    {
        model::AddressSpace& space = server.address_space();
        const model::NodeIndex folder = space.resolve(nodes.folder());
        if (auto attached = raiser_.attach(space, folder, server.event_queue()); !attached) {
            return attached;
        }
        return errors_.publish(server, nodes, log);
    }

    void happened(const controller::MachineEvent& event) override { raiser_.happened(event); }
    void errors_changed() override { errors_.refresh(); }

private:
    controller::MachineEventRaiser raiser_;
    controller::MachineErrorNodes errors_;
};

/// The program of a machine as one server publishes it (W588, 6-2). Outlives that server and is
/// used on its thread.
class MachineProgram {
public:
    /// `config` must have a program and outlive this object. Throws ConfigError.
    explicit MachineProgram(const ControllerConfig& config);

    /// Adds the nodes' namespace to a server that is not served yet, and creates the PLC with the
    /// program's variables. `memory_of` provides their memory, like Runtime::memory_of, and is
    /// called again by edit(). Throws ConfigError.
    using MemoryOf = std::function<std::span<std::byte>(const controller::GlobalVariable&)>;
    [[nodiscard]] std::unique_ptr<controller::Plc> make_plc(server::Server& server,
                                                            MemoryOf memory_of);
    /// Adds the nodes of W588, 6-2-1, after make_plc(), and shows the errors in the machine's log,
    /// which must outlive this object; `source` is the index of the PLC's image. Returns the
    /// controller's folder. Throws ConfigError.
    model::NodeIndex publish(server::Server& server, std::uint32_t source,
                             const controller::MachineEventLog& log);

    /// Adds what is new in `edited` and removes what it no longer has (W588, 3-3-2 and 4-2-5); call
    /// it after publish(). The task may run and never waits. Fails if a download is required:
    /// nothing was changed, or nodes are missing that a download adds. check_edit() must have
    /// succeeded.
    [[nodiscard]] Configured<controller::ProgramAddition>
    edit(controller::PublishedProgram::Edition edited, server::Server& server);

    /// See PublishedProgram.
    [[nodiscard]] const std::vector<controller::PublishedProgram::Edition>& editions() const
    {
        return program_->editions();
    }
    /// Shows the mode to clients; call it after publish().
    void show_mode(server::Server& server, controller::MachineMode mode) const;

    /// Tells the log what is left out of the program.
    void tell_left_out(LogSink& log) const;
    [[nodiscard]] const controller::Publication& publication() const
    {
        return program_->publication();
    }
    [[nodiscard]] const controller::ProgramTypes& types() const { return program_->types(); }
    /// Valid after make_plc().
    [[nodiscard]] const controller::ProgramImage& image() const { return *image_; }
    /// Shows the machine's events to clients, after publish().
    [[nodiscard]] controller::MachineEventListener& events() { return view_; }

private:
    [[nodiscard]] controller::MachineNodesOptions node_options(std::uint32_t source) const;

    const ControllerConfig& config_;
    std::unique_ptr<controller::PublishedProgram> program_;
    std::optional<controller::ProgramImage> image_;
    std::optional<controller::MachineNodes> nodes_;
    MachineView view_;
};

} // namespace busbar::product

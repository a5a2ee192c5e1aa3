#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <busbar/controller/machine_event_log.hpp>
#include <busbar/controller/machine_nodes.hpp>
#include <busbar/controller/plc.hpp>
#include <busbar/controller/published_program.hpp>
#include <busbar/server/server.hpp>

#include "machine_view.hpp"
#include "product/configuration/config.hpp"

namespace busbar::product {

/// The name of a machine's folder.
[[nodiscard]] const std::string& controller_name(const ControllerConfig& config);

/// A machine's program as one server publishes it (W588, 6-2). Outlives that server, on whose
/// thread it is.
class MachineProgram {
public:
    /// `config` has a program and must outlive it. Throws ConfigError.
    explicit MachineProgram(const ControllerConfig& config);

    /// Adds the nodes' namespace to a server that is not served yet, and makes the PLC with the
    /// program's variables, which lie where `memory_of` says, as Runtime::memory_of does, and is
    /// asked again by edit(). Throws ConfigError.
    using MemoryOf = std::function<std::span<std::byte>(const controller::GlobalVariable&)>;
    [[nodiscard]] std::unique_ptr<controller::Plc> make_plc(server::Server& server,
                                                            MemoryOf memory_of);
    /// The nodes of W588, 6-2-1, after make_plc(), and what stands in the machine's log, which
    /// must outlive it; `source` is the index of the PLC's image. Gives the controller's folder.
    /// Throws ConfigError.
    model::NodeIndex publish(server::Server& server, std::uint32_t source,
                             const controller::MachineEventLog& log);

    /// Adds what `edited` has and the program has not, and takes out what it has not any more
    /// (W588, 3-3-2 and 4-2-5), after publish(); the task may run, and waits for nothing. The
    /// problem is that it takes a download: nothing was changed, or nodes are missing which a
    /// download brings. check_edit() must have found nothing against it.
    [[nodiscard]] Configured<controller::ProgramAddition>
    edit(controller::PublishedProgram::Edition edited, server::Server& server);

    /// See PublishedProgram.
    [[nodiscard]] const std::vector<controller::PublishedProgram::Edition>& editions() const
    {
        return program_->editions();
    }
    /// After publish(): what clients see as the mode.
    void show_mode(server::Server& server, controller::MachineMode mode) const;

    [[nodiscard]] const controller::Publication& publication() const
    {
        return program_->publication();
    }
    [[nodiscard]] const controller::ProgramTypes& types() const { return program_->types(); }
    /// From make_plc() on.
    [[nodiscard]] const controller::ProgramImage& image() const { return *image_; }
    /// What clients see of the machine's events, from publish() on.
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

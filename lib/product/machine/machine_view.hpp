#pragma once

#include <busbar/controller/machine_error_nodes.hpp>
#include <busbar/controller/machine_event_raiser.hpp>

namespace busbar::product {

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

} // namespace busbar::product

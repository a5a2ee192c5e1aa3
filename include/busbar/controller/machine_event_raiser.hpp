#pragma once

#include <memory>
#include <mutex>

#include <busbar/controller/machine_event_log.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/event.hpp>

namespace busbar::controller {

/// Raises an OPC UA event for each event of the machine: a SystemEventType (Part 5, 6.4.28) if the
/// address space has that type, otherwise a BaseEventType. Its source is the controller's folder,
/// its severity that of the level (see severity_of), and its message has the code, the name and the
/// attached information: "35D40000 Unsupported Data Type: 21". Any thread.
class BUSBAR_API MachineEventRaiser final : public MachineEventListener {
public:
    /// Makes the folder a notifier below the Server object (Part 3, 7.17). Errors are those of
    /// AddressSpace. Before this call, and whenever there is no server, events are only in the log.
    [[nodiscard]] Result<void> attach(model::AddressSpace& address_space, model::NodeIndex folder,
                                      std::shared_ptr<server::EventQueue> queue);

    void happened(const MachineEvent& event) override;

private:
    [[nodiscard]] server::Event event_of(const MachineEvent& event) const;

    std::mutex mutex_; // guards all that follows
    NodeId event_type_;
    NodeId source_;
    std::shared_ptr<server::EventQueue> queue_;
};

} // namespace busbar::controller

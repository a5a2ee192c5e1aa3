#pragma once

#include <memory>
#include <vector>

#include <busbar/controller/plc.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/event.hpp>

namespace busbar::controller {

/// Raises a PLC's events in a server. An event is a BaseEventType whose source is the variable; it
/// has the configuration's severity and message, and the scan's time.
class BUSBAR_API PlcEvents {
public:
    /// Makes the folder of publish_variables, or that of a machine, a notifier below the Server
    /// object and the variables of its events its event sources (Part 3, 7.17 and 7.18). Errors are
    /// those of AddressSpace. `plc` must outlive the result.
    [[nodiscard]] static Result<PlcEvents> create(model::AddressSpace& address_space,
                                                  model::NodeIndex folder, const Plc& plc,
                                                  std::shared_ptr<server::EventQueue> queue);

    /// Raises the events of the last scan, which was at `time`. For the scanning thread, after the
    /// scan: neither allocates nor frees.
    void raise(DateTime time) const;

private:
    PlcEvents(const Plc& plc, std::shared_ptr<server::EventQueue> queue)
        : plc_{&plc}, queue_{std::move(queue)}
    {
    }

    const Plc* plc_;
    std::shared_ptr<server::EventQueue> queue_;
    /// The raised events without their time, indexed like Plc::events().
    std::vector<std::shared_ptr<const server::Event>> events_;
};

} // namespace busbar::controller

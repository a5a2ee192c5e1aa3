#pragma once

#include <memory>
#include <vector>

#include <busbar/controller/plc.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/event.hpp>

namespace busbar::controller {

/// Reports to a server what happens in a PLC. An event is a BaseEventType whose source is the
/// variable; it has the configuration's severity and message, and the scan's time.
class BUSBAR_API PlcEvents {
public:
    /// Makes the folder of publish_variables, or that of a machine, a notifier below the Server
    /// object and the variables that are watched its event sources (Part 3, 7.17 and 7.18). Errors
    /// are those of AddressSpace. `plc` must outlive the result.
    [[nodiscard]] static Result<PlcEvents> create(model::AddressSpace& address_space,
                                                  model::NodeIndex folder, const Plc& plc,
                                                  std::shared_ptr<server::EventQueue> queue);

    /// Raises what happened in the last scan, which was at `time`. For the thread that scans,
    /// after the scan: neither allocates nor frees.
    void raise(DateTime time) const;

private:
    PlcEvents(const Plc& plc, std::shared_ptr<server::EventQueue> queue)
        : plc_{&plc}, queue_{std::move(queue)}
    {
    }

    const Plc* plc_;
    std::shared_ptr<server::EventQueue> queue_;
    /// What is raised, without its time, by the places in Plc::events().
    std::vector<std::shared_ptr<const server::Event>> events_;
};

} // namespace busbar::controller

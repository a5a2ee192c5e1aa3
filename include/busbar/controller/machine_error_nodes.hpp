#pragma once

#include <atomic>
#include <span>

#include <busbar/controller/machine_event_log.hpp>
#include <busbar/controller/machine_nodes.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/detail/hand_over.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/server.hpp>

namespace busbar::controller {

/// Returns MajorFault if one of these is a major fault, ContinuousError for a partial or minor
/// fault (W588, 6-2-1 and 9-1-2); lower levels are not errors.
[[nodiscard]] BUSBAR_API ErrorState error_state_of(std::span<const MachineEvent> current_errors);

/// The current errors of a controller, as nodes for its clients:
///
///     Objects/<controller name>
///         DeviceState
///             ErrorState             of MachineNodes, set from here
///         PLCError                   "Controller/PLCError"
///             Level                  "Controller/PLCError/Level", and so on
///             Code
///             CurrentErrors
///
/// Level and Code are the outputs of the instruction GetPLCError: the highest level of fault, and
/// within it the highest event code (W588, 9-1-1). The manual has no nodes for
/// these outputs, so the names are our own. Level is a String, "Partial fault" or "Minor fault",
/// and "NoError" if there is none; Code is a UInt32, then 0. CurrentErrors has a String for each
/// current error, including observations, in the order of their occurrence: "35D40000 Unsupported
/// Data Type: 21".
///
/// For the server's thread, except refresh(). May be destroyed before or after the server.
class BUSBAR_API MachineErrorNodes final : public server::DataSource {
public:
    MachineErrorNodes() = default;

    /// Adds the nodes and shows the current errors. Call it once, before clients connect. `nodes`
    /// are those of this server; all three must stay in place as long as the server is served.
    /// Errors are those of AddressSpace; nodes that were added before an error stay.
    [[nodiscard]] Result<void> publish(server::Server& server, const MachineNodes& nodes,
                                       const MachineEventLog& log);
    /// The log's current errors have changed: clients see them soon, when the server next handles
    /// completions, for which its Waker is called. Any thread; does not wait.
    void refresh();

    void read(server::ReadBatch batch) override;
    void attach(server::Waker* waker) override;
    void handle_completions() override;

private:
    [[nodiscard]] Result<void> add_nodes(model::AddressSpace& space, const MachineNodes& nodes);
    void show();

    server::Server* server_{nullptr};
    const MachineNodes* nodes_{nullptr};
    const MachineEventLog* log_{nullptr};
    model::NodeHandle level_;
    model::NodeHandle code_;
    model::NodeHandle current_;
    std::atomic<bool> is_stale_{false};
    busbar::detail::WakerSlot waker_;
};

} // namespace busbar::controller

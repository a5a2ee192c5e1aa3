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

/// MajorFault if one of these is, else ContinuousError for a partial or minor fault (seed 000,
/// 6-2-1 and 9-1-2); what is less is no error.
[[nodiscard]] BUSBAR_API ErrorState error_state_of(std::span<const MachineEvent> current_errors);

/// The current errors of a controller, for its clients:
///
///     Objects/<controller name>
///         DeviceState
///             ErrorState             of MachineNodes, set from here
///         PLCError                   "Controller/PLCError"
///             Level                  "Controller/PLCError/Level", and so on
///             Code
///             CurrentErrors
///
/// Level and Code are what the instruction GetPLCError tells: the highest level of fault, and in
/// that the highest event code (seed 000, 9-1-1). The manual knows them as outputs of an
/// instruction and has no nodes for them, so that these names are our own. Level is a String,
/// "Partial fault" or "Minor fault", and "NoError" where there is none; Code is an UInt32, then 0.
/// CurrentErrors has a String for each error that stands, observations too, in the order in which
/// they came: "35D40000 Unsupported Data Type: 21".
///
/// On the server's thread, but for refresh(). May end before or after the server.
class BUSBAR_API MachineErrorNodes final : public server::DataSource {
public:
    MachineErrorNodes() = default;

    /// Adds the nodes and shows what stands. Once, before clients connect. `nodes` are those of
    /// this server; all three must stay where they are as long as the server is served. Errors are
    /// those of AddressSpace; nodes that were added before stay.
    [[nodiscard]] Result<void> publish(server::Server& server, const MachineNodes& nodes,
                                       const MachineEventLog& log);
    /// Other errors stand in the log than before: clients are shown them soon, when the server next
    /// handles completions, for which its Waker is called. Any thread; waits for nothing that
    /// waits.
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

#pragma once

#include "diagnostics_needs.hpp"
#include "server/rights/live_values.hpp"
#include "session_nodes.hpp"

namespace busbar::server::detail {

/// The present values of Variables below the Server object (Part 5, 6.3 and 8.3.2), i=2253, and of
/// sessions. Takes constant time, but for the arrays of ServerDiagnostics, of which some are not
/// for every reader.
class ServerObject final : public LiveValues {
public:
    ServerObject(const DiagnosticsNeeds& needs, const SessionNodes& session_nodes)
        : needs_{needs}, session_nodes_{session_nodes}
    {
    }

    [[nodiscard]] Result<DataValue> find(const NodeId& node,
                                         const ReadingUser& reader) const override;

private:
    /// Of a Variable of SessionNodes; the refusal is the value's status.
    [[nodiscard]] DataValue session_value(const NodeId& node, const ReadingUser& reader) const;

    const DiagnosticsNeeds& needs_;
    const SessionNodes& session_nodes_;
};

} // namespace busbar::server::detail

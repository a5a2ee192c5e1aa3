#pragma once

#include "diagnostics_needs.hpp"
#include "server/rights/live_values.hpp"
#include "session_nodes.hpp"

namespace busbar::server::detail {

/// The present values of Variables below Server.ServerDiagnostics, i=2274, and of the Objects of
/// sessions (Part 5, 6.3.3 to 6.3.5). Bad_NotReadable while diagnostics are off; some are not for
/// every reader. Takes constant time, except for arrays.
class DiagnosticValues final : public LiveValues {
public:
    DiagnosticValues(const DiagnosticsNeeds& needs, const SessionNodes& session_nodes)
        : needs_{needs}, session_nodes_{session_nodes}
    {
    }

    [[nodiscard]] Result<DataValue> find(const NodeId& node,
                                         const ReadingUser& reader) const override;

private:
    /// Returns the value of a Variable of SessionNodes; a refusal is the value's status.
    [[nodiscard]] DataValue session_value(const NodeId& node, const ReadingUser& reader) const;

    const DiagnosticsNeeds& needs_;
    const SessionNodes& session_nodes_;
};

} // namespace busbar::server::detail

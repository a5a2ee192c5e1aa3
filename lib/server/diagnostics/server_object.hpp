#pragma once

#include "diagnostics_needs.hpp"
#include "server/rights/live_values.hpp"

namespace busbar::server::detail {

/// The present values of Variables below the Server object (Part 5, 6.3 and 8.3.2), i=2253: status
/// and capabilities, and added ones. Takes constant time.
class ServerObject final : public LiveValues {
public:
    explicit ServerObject(const DiagnosticsNeeds& needs) : needs_{needs} {}

    /// `values` provides further ones; called once, and it must outlive this.
    void add(const LiveValues& values) { others_ = &values; }
    [[nodiscard]] bool has_others() const { return others_ != nullptr; }

    [[nodiscard]] Result<DataValue> find(const NodeId& node,
                                         const ReadingUser& reader) const override;

private:
    const DiagnosticsNeeds& needs_;
    const LiveValues* others_{nullptr};
};

/// Adds references from the folder of ModellingRules to those in the address space (Part 5, 6.3.2).
void list_modelling_rules(model::AddressSpace& space);

} // namespace busbar::server::detail

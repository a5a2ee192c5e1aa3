#pragma once

#include <busbar/product/runtime.hpp>

namespace busbar::product {

/// The runtime of busbar-controller: its PLC does what the configuration says ([[plc.program]]),
/// and clients can simulate its hardware.
class SimulatedRuntime final : public Runtime {
public:
    [[nodiscard]] Configured<std::unique_ptr<LoadedProgram>>
    load(controller::Plc& plc, const controller::Program* program) override;
    /// Simulated by clients, like the other hardware.
    [[nodiscard]] StorageMedium* medium() override { return &medium_; }
    [[nodiscard]] bool is_simulated() const override { return true; }

private:
    StorageMedium medium_;
};

} // namespace busbar::product

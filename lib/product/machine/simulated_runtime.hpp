#pragma once

#include <cstdint>
#include <functional>

#include <busbar/model/address_space.hpp>
#include <busbar/product/runtime.hpp>
#include <busbar/server/method_table.hpp>

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

/// Adds the Object "Hardware" to a machine's folder, with the Method Simulate. Its argument is
/// "major fault", "partial fault", "partial fault of the server", "minor fault", "minor fault of
/// the server", "watchdog", "medium out", "medium in", or for a medium "medium taken", "medium
/// full" or "medium protected", until it is in; anything else gives Bad_OutOfRange. Users who may
/// stop a server can call it: Engineer, ConfigureAdmin and SecurityAdmin (W588, 8-1). `happened` is
/// called within the Call, on the server's thread. `table`, whose index is `source`, and `medium`,
/// which may be null, must outlive the server.
[[nodiscard]] Result<void> publish_hardware(model::AddressSpace& space, model::NodeIndex folder,
                                            server::MethodTable& table, std::uint32_t source,
                                            StorageMedium* medium,
                                            std::function<void(HardwareEvent)> happened);

} // namespace busbar::product

#include "simulated_runtime.hpp"

namespace busbar::product {

namespace {

class SimulatedProgram final : public LoadedProgram {
public:
    explicit SimulatedProgram(controller::Plc& plc) : plc_{plc} {}

    void scan(DateTime, Duration elapsed) override { plc_.run_programs(elapsed); }

private:
    controller::Plc& plc_;
};

} // namespace

Configured<std::unique_ptr<LoadedProgram>> SimulatedRuntime::load(controller::Plc& plc,
                                                                  const controller::Program*)
{
    return std::make_unique<SimulatedProgram>(plc);
}

} // namespace busbar::product

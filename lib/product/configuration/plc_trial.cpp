#include "plc_trial.hpp"

#include <busbar/controller/plc.hpp>
#include <busbar/controller/published_program.hpp>

#include "config.hpp"
#include "product/machine/program_file.hpp"

namespace busbar::product {

PlcTrial::PlcTrial(const ControllerConfig& config)
    : program{config.machine.program}, reading{config.machine.reading},
      publishing{config.machine.publishing},
      elementary{config.machine.types.elementary}, labels{config.labels.program},
      labels_file{config.labels.program_file}, label_reading{config.labels.reading},
      label_options{config.labels.options}, plc{config.plc}, image{config.image}
{
}

Configured<void> PlcTrial::run() const
{
    constexpr auto forget = [](const auto&) {};
    if (labels != nullptr) {
        return controller::SimulatedLabels::create(*labels, label_options)
            .transform_error(
                [&](Problem problem) { return in_file(std::move(problem), labels_file, *labels); })
            .and_then([&](const auto& made) {
                const auto running = made->program();
                return controller::Plc::create(plc, running->types(), running->image());
            })
            .transform(forget);
    }
    if (program == nullptr) {
        return controller::Plc::create(plc).transform(forget);
    }
    const auto published = controller::PublishedProgram::create(program, publishing);
    return published->make_image(1, {.image = image, .elementary = elementary})
        .and_then([&](const controller::ProgramImage& made) {
            return controller::Plc::create(plc, published->types(), made);
        })
        .transform(forget);
}

} // namespace busbar::product

#include "reading.hpp"

#include <utility>

namespace busbar::product {

Reading read_sources(const Origin& origin)
{
    Reading reading;
    std::string preset = origin.preset;
    if (!origin.project.empty()) {
        reading.project = std::make_unique<KeptProject>(origin.project);
        const controller::Project* const project = reading.project->project();
        if (preset.empty() && project != nullptr) {
            preset = project->preset;
        }
    }
    reading.settings = std::make_unique<Settings>(origin.file, std::move(preset));
    reading.config = reading.settings->config();
    reading.config.port = origin.port.value_or(reading.config.port);
    if (reading.project) {
        reading.project->apply(reading.config, origin.port.has_value());
    }
    return reading;
}

} // namespace busbar::product

#include "reading.hpp"

#include <utility>

namespace busbar::product {

namespace {

void set_names(server::ServerConfig& server, const ProductNames& names)
{
    server.build.manufacturer_name = names.manufacturer;
    server.build.software_version = names.version;
    if (!names.product_uri.empty()) {
        server.product_uri = names.product_uri;
    }
}

} // namespace

Reading read_sources(const Origin& origin, Substitutes substitutes)
{
    Reading reading;
    std::string preset = origin.preset;
    if (!origin.project.empty()) {
        reading.project = std::make_shared<KeptProject>(origin.project, substitutes.project,
                                                        substitutes.takes_other_project);
        const controller::Project* const project = reading.project->project();
        if (preset.empty() && project != nullptr) {
            preset = project->preset;
        }
    }
    const auto complete = [project = reading.project, port = origin.port,
                           names = origin.names](ControllerConfig& config,
                                                 const administration::SettingValues& changes) {
        set_names(config.server, names);
        if (project != nullptr) {
            project->apply(config, changes);
        }
        config.port = port.value_or(config.port);
    };
    reading.settings = std::make_unique<Settings>(origin.file, std::move(preset), complete,
                                                  SourceFiles{std::move(substitutes.files)});
    reading.config = reading.settings->config();
    return reading;
}

} // namespace busbar::product

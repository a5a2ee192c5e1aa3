#include "reading.hpp"

#include <utility>

#include <busbar/storage/folder_storage.hpp>

#include "setting_keys.hpp"

namespace busbar::product {

namespace {

Overlays overlays_of(const Configuration& configuration,
                     const std::shared_ptr<const KeptProject>& project)
{
    Overlays over{
        .preset = configuration.preset, .port = configuration.port, .names = configuration.names};
    if (project != nullptr) {
        over.project = [project](ControllerConfig& config,
                                 const administration::SettingValues& changes) {
            project->apply(config, changes);
        };
        if (const controller::Project* const served = project->project()) {
            over.project_preset = served->preset;
        }
    }
    return over;
}

/// Opens the project in the folder, which another process may use; null if there is none.
std::shared_ptr<const KeptProject> project_in(const std::string& folder)
{
    constexpr std::size_t most = 256U << 20U;
    storage::FolderStorage files{folder};
    const auto bytes = read_file(files, storage_path("project", "project.busbar"), most);
    if (!bytes) {
        return nullptr;
    }
    std::string document{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    return std::make_shared<const KeptProject>(std::string{}, std::move(document), true);
}

} // namespace

Reading read_sources(const Configuration& configuration, Substitutes substitutes)
{
    Reading reading;
    if (!configuration.project.empty()) {
        reading.project = std::make_shared<KeptProject>(configuration.project, substitutes.project,
                                                        substitutes.takes_other_project,
                                                        substitutes.running.get());
    }
    reading.settings =
        std::make_unique<Settings>(configuration.file, overlays_of(configuration, reading.project),
                                   std::move(substitutes.files));
    reading.config = reading.settings->config();
    return reading;
}

Provenance provenance_of(const Configuration& configuration)
{
    SourceFiles sources;
    Layers layers{.text = read_config_text(configuration.file, sources),
                  .name = name_of_file(configuration.file)};
    layers.over = overlays_of(
        configuration, configuration.project.empty() ? nullptr : project_in(configuration.project));
    auto settings =
        controller_settings(with_preset(parse_table(layers.text, layers.name), layers.over));
    storage::FolderStorage folder{certificate_folder(parse_table(layers.text, layers.name))};
    administration::SettingList changed{folder, Settings::file_name, settings};
    expect(changed.load());
    layers.changes = changed.changes();
    layers.authors = changed.authors();
    return {std::move(layers), std::move(settings), sources};
}

} // namespace busbar::product

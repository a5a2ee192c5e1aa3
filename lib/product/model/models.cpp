#include "models.hpp"

#include <busbar/model/nodeset.hpp>
#include <busbar/server/namespace_metadata.hpp>

#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

namespace {

constexpr std::size_t max_model_size = model::NodeSetLimits{}.max_file_size;

} // namespace

void load_models(server::Server& server, const ControllerConfig& config, SourceFiles& sources,
                 LogSink& log)
{
    const auto& files = config.nodesets;
    const bool is_lenient = !config.nodesets_strict;
    if (files.empty()) {
        return;
    }
    std::vector<model::NodeSetSource> models;
    for (const std::string& file : files) {
        models.push_back({file, *expect(sources.text(file, max_model_size)), is_lenient});
    }
    const auto loaded = model::load_nodesets(server.address_space(), models);
    if (!loaded) {
        std::string lines = "the information models cannot be loaded";
        for (const Problem& problem : loaded.error()) {
            lines += "\n" + text(problem);
        }
        if (!is_lenient) {
            lines += "\nwith nodesets_strict = false in [server] the controller repairs what files "
                     "of vendors often have wrong, and says what it did";
        }
        throw ConfigError{Problem{.text = lines}};
    }
    server::describe_models(server, loaded->extras.models);
    for (const Problem& note : loaded->notes) {
        log.write(LogLevel::Warning, "model", text(note));
    }
    for (const model::NodeSetRepair& repair : loaded->repairs) {
        log.write(LogLevel::Warning, "model", text(repair));
    }
    for (const std::string& line : model::counted_repairs(*loaded)) {
        log.write(LogLevel::Warning, "model", "repaired " + line);
    }
    log.write(LogLevel::Info, "model",
              std::to_string(loaded->node_count) + " nodes of " + std::to_string(files.size()) +
                  " files were loaded");
}

} // namespace busbar::product

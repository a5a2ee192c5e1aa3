#include "models.hpp"

#include <busbar/model/nodeset.hpp>
#include <busbar/server/namespace_metadata.hpp>

#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

namespace {

constexpr std::size_t max_model_size = model::NodeSetLimits{}.max_file_size;

} // namespace

void load_models(server::Server& server, const std::vector<std::string>& files,
                 SourceFiles& sources, LogSink& log)
{
    if (files.empty()) {
        return;
    }
    std::vector<model::NodeSetSource> models;
    for (const std::string& file : files) {
        models.push_back({file, *expect(sources.text(file, max_model_size))});
    }
    const auto loaded = model::load_nodesets(server.address_space(), models);
    if (!loaded) {
        std::string lines = "the information models cannot be loaded";
        for (const Problem& problem : loaded.error()) {
            lines += "\n" + text(problem);
        }
        throw ConfigError{Problem{.text = lines}};
    }
    server::describe_models(server, loaded->extras.models);
    for (const Problem& note : loaded->notes) {
        log.write(LogLevel::Warning, "model", text(note));
    }
    log.write(LogLevel::Info, "model",
              std::to_string(loaded->node_count) + " nodes of " + std::to_string(files.size()) +
                  " files were loaded");
}

} // namespace busbar::product

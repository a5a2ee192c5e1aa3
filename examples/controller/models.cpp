#include "models.hpp"

#include <busbar/model/nodeset.hpp>

#include "toml_reader.hpp"

namespace busbar::example {

void load_models(model::AddressSpace& space, const std::vector<std::string>& files, LogSink& log)
{
    if (files.empty()) {
        return;
    }
    std::vector<model::NodeSetSource> sources;
    for (const std::string& file : files) {
        sources.push_back({file});
    }
    const auto loaded = model::load_nodesets(space, sources);
    if (!loaded) {
        std::string text = "the information models cannot be loaded";
        for (const model::NodeSetError& error : loaded.error()) {
            text += "\n" + error.text();
        }
        throw ConfigError{text};
    }
    for (const model::NodeSetError& note : loaded->notes) {
        log.write(LogLevel::Warning, "model", note.text());
    }
    log.write(LogLevel::Info, "model",
              std::to_string(loaded->node_count) + " nodes of " + std::to_string(files.size()) +
                  " files were loaded");
}

} // namespace busbar::example

#pragma once

#include <string>
#include <vector>

#include <busbar/core/log.hpp>
#include <busbar/server/server.hpp>

#include "product/store/source_files.hpp"

namespace busbar::product {

/// Adds the nodes of NodeSet2 files, given in any order, and logs oddities in them;
/// Server.Namespaces has their versions. Throws a ConfigError with a line for each mistake; nothing
/// was added then.
void load_models(server::Server& server, const std::vector<std::string>& files,
                 SourceFiles& sources, LogSink& log);

} // namespace busbar::product

#pragma once

#include <busbar/core/log.hpp>
#include <busbar/server/server.hpp>

#include "product/configuration/config.hpp"
#include "product/store/source_files.hpp"

namespace busbar::product {

/// Adds the nodes of the configuration's NodeSet2 files, and logs oddities in them and what was
/// repaired; Server.Namespaces has their versions. Throws a ConfigError with a line for each
/// mistake; nothing was added then.
void load_models(server::Server& server, const ControllerConfig& config, SourceFiles& sources,
                 LogSink& log);

} // namespace busbar::product

#pragma once

#include <string>

#include <busbar/server/conformance.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// What the controller does around its server, for what that claims; `has_time_sync` as the host's
/// clock follows a time service.
[[nodiscard]] server::ProgramConformance program_of(const ControllerConfig& config,
                                                    bool has_time_sync);

/// What a controller with this configuration claims. Makes its server, but no files: it has a key
/// that is forgotten, and a certificate of `now`. Throws ConfigError.
[[nodiscard]] server::Conformance conformance_of(ControllerConfig config, DateTime now,
                                                 bool has_time_sync);

/// What --print-conformance prints: each profile of servers with what it lacks, then the units that
/// are claimed.
[[nodiscard]] std::string describe_conformance(const server::Conformance& conformance);
/// The same as JSON, profiles of clients included.
[[nodiscard]] std::string conformance_json(const server::Conformance& conformance);

/// Prints that of a file, of the built-in configuration without one; 0, as a program's end.
int print_conformance(const std::string& file, bool as_json, DateTime now, bool has_time_sync);

} // namespace busbar::product

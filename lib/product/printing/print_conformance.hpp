#pragma once

#include <string>

#include <busbar/server/conformance.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The capabilities of the program around its server, which its claims depend on; `has_time_sync`
/// if the host's clock follows a time service.
[[nodiscard]] server::ProgramConformance program_of(const ControllerConfig& config,
                                                    bool has_time_sync);

/// The claims of a controller with this configuration. Creates its server but no files: the key is
/// temporary, and the certificate begins at `now`. Throws ConfigError.
[[nodiscard]] server::Conformance conformance_of(ControllerConfig config, DateTime now,
                                                 bool has_time_sync);

/// The text of --print-conformance: each server profile with what it lacks, then the claimed units.
[[nodiscard]] std::string describe_conformance(const server::Conformance& conformance);
/// The same as JSON, including profiles of clients.
[[nodiscard]] std::string conformance_json(const server::Conformance& conformance);

/// Prints it for a file, or for the built-in configuration; returns 0 as exit code.
int print_conformance(const std::string& file, bool as_json, DateTime now, bool has_time_sync);

} // namespace busbar::product

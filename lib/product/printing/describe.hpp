#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <busbar/server/conformance.hpp>

#include "core/json_writer.hpp"
#include "product/configuration/config.hpp"
#include "product/configuration/reading.hpp"

/// The options of busbar-controller that print: describe_*() and explain() return the texts.

namespace busbar::product {

/// The text of --print-limits: each limit in force with its value, the key of [limits] that sets
/// it, the memory that peers can make the controller hold by it, and the sum.
[[nodiscard]] std::string describe_limits(const ControllerConfig& config);
/// Prints it for a file, or for the built-in configuration; returns 0 as exit code.
int print_limits(const std::string& file);

/// The text of --print-capacities: the maximum capacities of a controller with this configuration,
/// as a Markdown table. lib/CONFORMANCE.md has the table of the built-in configuration; Part 7
/// calls it the documentation of core capacities.
[[nodiscard]] std::string describe_capacities(const ControllerConfig& config);
/// Prints it for a file, or for the built-in configuration; returns 0 as exit code.
int print_capacities(const std::string& file);

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

/// The text of --explain for a key of the configuration: its value in force, where it comes from
/// and what it would be otherwise, the range, and when a change takes effect. For "all" a line for
/// each key. Empty for an unknown key.
[[nodiscard]] std::string explain(const Provenance& provenance, const std::string& key);
/// Suggests keys: those that contain the word, otherwise the most similar ones.
[[nodiscard]] std::vector<std::string> keys_like(const Provenance& provenance,
                                                 const std::string& word);
/// Prints the explanation for `configuration`; returns 0, or 2 for an unknown key.
[[nodiscard]] int print_explanation(const Configuration& configuration, const std::string& key);

// --check: each function prints what would become of programs and of backends, or adds an object
// for each of them to a list if `json` is not null.

/// Tells for each file of a program what would be published with the limits of the configuration,
/// what not, and what is left out, each with its reason. True if all of it is understood and
/// everything that is to be published would be.
[[nodiscard]] bool check_programs(const ControllerConfig& config,
                                  const std::vector<std::string>& files, detail::JsonWriter* json);
/// Connects to the PLCs of a configuration's backends, asks for each address once, and tells what
/// is read, how fast, and what is wrong. True if everything was read.
[[nodiscard]] bool check_backends(const ControllerConfig& config, detail::JsonWriter* json);

/// Adds a member to an object.
void add_member(detail::JsonWriter& json, const char* name, const std::string& text);
void add_member(detail::JsonWriter& json, const char* name, std::uint64_t number);

/// Checks files of programs, or without any what the configuration has of both. Returns the exit
/// code: 0 if all is well, otherwise 1.
int check(const ControllerConfig& config, std::vector<std::string> files, bool is_json);

} // namespace busbar::product

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/json_writer.hpp"
#include "product/configuration/config.hpp"

/// `--check`: what would become of programs and of backends. Each function prints it, or adds an
/// object for each program or backend to a list if `json` is not null.
namespace busbar::product {

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

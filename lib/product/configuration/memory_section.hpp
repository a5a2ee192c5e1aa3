#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <busbar/server/worst_case_memory.hpp>

#include "config.hpp"

/// `memory` of [limits]: what peers together may make the controller hold.
namespace busbar::product {

/// Nothing without the key.
[[nodiscard]] std::optional<std::uint64_t> read_memory(const TomlTable& limits);
/// Sets the limits to those for that memory, before all other keys are read.
void take_memory(const TomlTable& root, std::uint64_t memory, ControllerConfig& config);
/// Refuses what has become more than that by other keys, but for structures of a program's image.
void check_memory(const TomlTable& limits, const ControllerConfig& config);

/// What peers can make a controller of this configuration hold, at worst: with the image of its
/// program, or one without structures.
[[nodiscard]] server::WorstCaseMemory worst_case_of(const ControllerConfig& config,
                                                    const server::ProcessImage& image);
[[nodiscard]] server::WorstCaseMemory worst_case_of(const ControllerConfig& config);

/// Bytes as people read them: "900 B", "64.0 KiB", "1.5 GiB".
[[nodiscard]] std::string size_text(std::uint64_t bytes);

} // namespace busbar::product

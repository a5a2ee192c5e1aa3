#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <busbar/server/worst_case_memory.hpp>

#include "config.hpp"

/// `memory` of [limits]: the total that peers may make the controller hold.
namespace busbar::product {

/// Reads the key; nothing without it.
[[nodiscard]] std::optional<std::uint64_t> read_memory(const TomlTable& limits);
/// Sets the limits for that memory, before all other keys are read.
void take_memory(const TomlTable& root, std::uint64_t memory, ControllerConfig& config);
/// Refuses limits that other keys raised above that memory; ignores structures of a program's
/// image.
void check_memory(const TomlTable& limits, const ControllerConfig& config);

/// Computes the memory that peers can make a controller of this configuration hold at worst: with
/// the image of its program, or one without structures.
[[nodiscard]] server::WorstCaseMemory worst_case_of(const ControllerConfig& config,
                                                    const server::ProcessImage& image);
[[nodiscard]] server::WorstCaseMemory worst_case_of(const ControllerConfig& config);

/// Writes a size for people: "900 B", "64.0 KiB", "1.5 GiB".
[[nodiscard]] std::string size_text(std::uint64_t bytes);

} // namespace busbar::product

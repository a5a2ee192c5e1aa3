#pragma once

#include "config.hpp"

namespace busbar::product {

/// [machine], with the program that it names. Before read_plc. Problems of the program's file have
/// its name, line and column.
void read_machine(const TomlTable& table, ControllerConfig& config);

/// The DataTypes of variables where neither a preset nor the configuration says: those of PLCopen,
/// if this build has them.
[[nodiscard]] controller::MachineTypeOptions default_types();

/// The program's variables as they are published; the configuration has a program.
[[nodiscard]] std::unique_ptr<controller::PublishedProgram>
publish_program(const ControllerConfig& config);

} // namespace busbar::product

#pragma once

#include "config.hpp"

namespace busbar::product {

/// [labels], with the program that it names. After read_machine and before read_plc. Problems of
/// the program's file have its name, line and column.
void read_labels(const TomlTable& table, ControllerConfig& config);

/// The labels of a PLC that does not scan yet; none without a program.
[[nodiscard]] std::unique_ptr<controller::SimulatedLabels> make_labels(const LabelConfig& config);

} // namespace busbar::product

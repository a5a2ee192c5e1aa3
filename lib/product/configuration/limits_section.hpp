#pragma once

#include "config.hpp"

namespace busbar::product {

/// What array_length can be raised to.
inline constexpr std::int64_t most_elements = 16'777'216;

/// `preset` or `memory` of [limits], before all else.
void read_preset(const TomlTable& root, ControllerConfig& config);
/// The rest of [limits], and [users.passwords].
void read_limits(const TomlTable& root, ControllerConfig& config);
/// Refuses a variable whose whole value would not go through these limits.
void check_size(const TomlTable& entry, const controller::PlcVariable& variable,
                const server::ServerLimits& limits);

} // namespace busbar::product

#pragma once

#include <optional>

#include <busbar/controller/plc_config.hpp>

namespace busbar::controller::detail {

/// Returns the variable's initial value with its type and dimensions; nothing if `variable.initial`
/// cannot be converted.
[[nodiscard]] std::optional<Variant> initial_value(const PlcVariable& variable);

} // namespace busbar::controller::detail

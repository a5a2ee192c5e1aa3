#pragma once

#include <optional>

#include <busbar/controller/plc_config.hpp>

namespace busbar::controller::detail {

/// The value that a variable begins with, of its type and dimensions; none if `variable.initial`
/// cannot be made into one.
[[nodiscard]] std::optional<Variant> initial_value(const PlcVariable& variable);

} // namespace busbar::controller::detail

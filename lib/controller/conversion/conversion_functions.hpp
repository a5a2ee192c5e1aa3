#pragma once

#include <busbar/controller/label_conversion.hpp>

namespace busbar::controller::detail {

/// The functions that convert between a value and a label of value_type() `label`, a pair for which
/// assignability() must not be No.
[[nodiscard]] LabelConversion::Functions conversion_functions(BuiltInType leaf,
                                                              backend::LabelType label);

/// The functions that scale between a value and a label, for both of which is_scalable() must be
/// true.
[[nodiscard]] LabelConversion::Functions scaled_functions(BuiltInType leaf,
                                                          backend::LabelType label);

} // namespace busbar::controller::detail

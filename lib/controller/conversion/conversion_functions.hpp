#pragma once

#include <busbar/controller/label_conversion.hpp>

namespace busbar::controller::detail {

/// What converts between a value and a label of value_type() `label`, which assignability() must
/// not say No to.
[[nodiscard]] LabelConversion::Functions conversion_functions(BuiltInType leaf,
                                                              backend::LabelType label);

/// What scales between them; is_scalable() must say so of both.
[[nodiscard]] LabelConversion::Functions scaled_functions(BuiltInType leaf,
                                                          backend::LabelType label);

} // namespace busbar::controller::detail

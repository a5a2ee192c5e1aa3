#pragma once

#include <cstddef>
#include <string>

#include <busbar/core/types.hpp>

namespace busbar::example {

/// A value for a terminal, at most `width` columns: "42", "[1, 2, 3]", "Bad_NodeIdUnknown".
[[nodiscard]] std::string text_of(const DataValue& value, std::size_t width);

} // namespace busbar::example

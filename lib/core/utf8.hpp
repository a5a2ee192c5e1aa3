#pragma once

#include <cstddef>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// The length of the valid UTF-8 sequence at the front of `text`, which is not empty; 0 if there is
/// none or it is a C1 control.
[[nodiscard]] BUSBAR_API std::size_t utf8_sequence(std::string_view text);

} // namespace busbar::detail

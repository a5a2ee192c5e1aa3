#pragma once

#include <string>
#include <string_view>

namespace busbar::controller::detail {

/// Returns the key that names are sorted by: UTF-16 code units with small ASCII letters as capitals
/// (W588, 6-2-2, step 1). Characters beyond 16 bits become surrogates, which precede U+E000 to
/// U+FFFF. `name` must be UTF-8.
[[nodiscard]] std::u16string sorting_key(std::string_view name);

} // namespace busbar::controller::detail

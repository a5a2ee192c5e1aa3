#pragma once

#include <string>
#include <string_view>

namespace busbar::controller::detail {

/// What names are put in order by: UTF-16 code units, small letters of ASCII as capitals (W588,
/// 6-2-2, step 1). Characters beyond 16 bits come as surrogates, before U+E000 to U+FFFF. `name`
/// must be UTF-8.
[[nodiscard]] std::u16string sorting_key(std::string_view name);

} // namespace busbar::controller::detail

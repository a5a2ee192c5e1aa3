#pragma once

#include <algorithm>
#include <string_view>

namespace busbar::detail {

/// Returns `c` with an upper-case ASCII letter turned into lower case, independent of the C
/// library's locale.
[[nodiscard]] constexpr char to_ascii_lower(char c)
{
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// True if both are equal except for the case of ASCII letters.
[[nodiscard]] inline bool is_same_ignoring_case(std::string_view a, std::string_view b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](char x, char y) { return to_ascii_lower(x) == to_ascii_lower(y); });
}

} // namespace busbar::detail

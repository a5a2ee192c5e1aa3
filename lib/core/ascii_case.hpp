#pragma once

#include <algorithm>
#include <string_view>

namespace busbar::detail {

/// `c`, an upper-case letter of ASCII as the lower-case one; whatever the C library's locale is.
[[nodiscard]] constexpr char to_ascii_lower(char c)
{
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Equal but for the case of ASCII letters.
[[nodiscard]] inline bool is_same_ignoring_case(std::string_view a, std::string_view b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](char x, char y) { return to_ascii_lower(x) == to_ascii_lower(y); });
}

} // namespace busbar::detail

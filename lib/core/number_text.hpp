#pragma once

#include <charconv>
#include <type_traits>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// Reads as std::from_chars does for floating point in its general format, with the C library.
[[nodiscard]] BUSBAR_API std::from_chars_result read_floating(const char* first, const char* last,
                                                              double& value);
[[nodiscard]] BUSBAR_API std::from_chars_result read_floating(const char* first, const char* last,
                                                              float& value);

/// std::from_chars; libc++ before version 20 has it for integers only.
template <typename Number>
[[nodiscard]] std::from_chars_result read_number(const char* first, const char* last, Number& value)
{
#ifndef __cpp_lib_to_chars
    if constexpr (std::is_floating_point_v<Number>) {
        return read_floating(first, last, value);
    } else
#endif
    {
        return std::from_chars(first, last, value);
    }
}

} // namespace busbar::detail

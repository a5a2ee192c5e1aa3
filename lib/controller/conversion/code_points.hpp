#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace busbar::controller::detail {

[[nodiscard]] constexpr bool is_surrogate(char32_t unit)
{
    return unit >= 0xD800 && unit <= 0xDFFF;
}

/// Takes the code point at the front of `text`, which must not be empty. Gives nothing, and leaves
/// `text` alone, if that is not UTF-8 (RFC 3629, 3).
[[nodiscard]] std::optional<char32_t> take_utf8(std::string_view& text);

/// Appends a character, which must be a code point but not a surrogate.
void append_utf8(char32_t character, std::string& text);

} // namespace busbar::controller::detail

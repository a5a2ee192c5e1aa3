#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace busbar::server::detail {

/// True if `text` matches `pattern` (Part 4, 7.7.3, Like): % stands for any characters, _ for one,
/// [a-c] for one of a list, [^a-c] for one that is not in it, and \ takes the next character as it
/// is. Characters are those of UTF-8; a byte that is none counts as one. A pattern whose list or
/// escape does not end matches nothing.
///
/// Takes time of at most text times pattern, of which it takes one from `steps_left` for each
/// comparison; nothing if they were used up.
[[nodiscard]] std::optional<bool> is_like(std::string_view text, std::string_view pattern,
                                          std::size_t& steps_left);

} // namespace busbar::server::detail

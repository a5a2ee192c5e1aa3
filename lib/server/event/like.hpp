#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace busbar::server::detail {

/// Returns true if `text` matches `pattern` (Part 4, 7.7.3, Like): % stands for any characters, _
/// for one, [a-c] for one of a list, [^a-c] for one that is not in it, and \ makes the next
/// character literal. Characters are those of UTF-8; an invalid byte counts as one. A pattern with
/// an unterminated list or escape matches nothing.
///
/// Takes at most time proportional to text times pattern, and decrements `steps_left` for each
/// comparison; returns nothing if they were used up.
[[nodiscard]] std::optional<bool> is_like(std::string_view text, std::string_view pattern,
                                          std::size_t& steps_left);

} // namespace busbar::server::detail

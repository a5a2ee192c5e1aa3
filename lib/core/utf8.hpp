#pragma once

#include <cstddef>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// The length of the valid UTF-8 sequence at the front of `text`, which is not empty; 0 if there is
/// none or it is a C1 control.
[[nodiscard]] BUSBAR_API std::size_t utf8_sequence(std::string_view text);

/// Whether the sequence changes the direction of the text around it, which then reads as another
/// one (Unicode's Bidi_Control).
[[nodiscard]] BUSBAR_API bool is_bidi_control(std::string_view sequence);

/// Whether people can read `text` as a name, and tell it from others: UTF-8 (Part 6, 5.2.2.4), not
/// empty, without control characters, those that change the direction of text, and spaces at its
/// ends. Names from clients become BrowseNames, which all others are sent.
[[nodiscard]] BUSBAR_API bool is_name(std::string_view text);

/// Bytes that the text of a BrowseName has at most (Part 3, 8.3: 512 characters).
inline constexpr std::size_t max_browse_name = 512;

/// The first `max_bytes` bytes of UTF-8, or less where a sequence would be cut through.
[[nodiscard]] BUSBAR_API std::string_view cut_short(std::string_view text, std::size_t max_bytes);

} // namespace busbar::detail

#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar::detail {

/// Returns the length of the valid UTF-8 sequence at the front of `text`, which is not empty; 0 if
/// it is not valid or is a C1 control.
[[nodiscard]] BUSBAR_API std::size_t utf8_sequence(std::string_view text);

/// Returns whether all of `text` is UTF-8 (Part 6, 5.2.2.4; RFC 3629), C1 controls included. ASCII
/// is checked 16 bytes at a time.
[[nodiscard]] BUSBAR_API bool is_utf8(std::string_view text);

/// Returns whether all of `text` is ASCII, which nearly all texts are. Inline and without a loop
/// for the last bytes, as the texts of a request are short and many.
[[nodiscard]] inline bool is_ascii(std::string_view text)
{
    std::size_t left = text.size();
    std::uint64_t word = 0;
    if (left < sizeof word) {
        unsigned all = 0;
        for (const char c : text) {
            all |= static_cast<unsigned char>(c);
        }
        return all < 0x80;
    }
    const char* at = text.data();
    std::uint64_t all = 0;
    for (; left > sizeof word; left -= sizeof word, at += sizeof word) {
        std::memcpy(&word, at, sizeof word);
        all |= word;
    }
    std::memcpy(&word, at + left - sizeof word, sizeof word); // some bytes for the second time
    return ((all | word) & 0x8080'8080'8080'8080U) == 0;
}

/// Returns what is_utf8 returns, sooner for short texts of ASCII.
[[nodiscard]] inline bool is_valid_text(std::string_view text)
{
    return is_ascii(text) || is_utf8(text);
}

/// Returns whether the sequence changes the direction of the text around it, so that it reads as
/// another one (Unicode's Bidi_Control).
[[nodiscard]] BUSBAR_API bool is_bidi_control(std::string_view sequence);

/// Returns whether people can read `text` as a name, and tell it from others: UTF-8 (Part 6,
/// 5.2.2.4), not empty, without control characters, without characters that change the direction of
/// text, and without spaces at its ends. Names from clients become BrowseNames, which all other
/// clients receive.
[[nodiscard]] BUSBAR_API bool is_name(std::string_view text);

/// Maximum number of bytes of a BrowseName's text (Part 3, 8.3: 512 characters).
inline constexpr std::size_t max_browse_name = 512;

/// Returns the first `max_bytes` bytes of UTF-8, or fewer if a sequence would be cut.
[[nodiscard]] BUSBAR_API std::string_view cut_short(std::string_view text, std::size_t max_bytes);

} // namespace busbar::detail

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <busbar/core/numeric_range.hpp>
#include <busbar/core/string.hpp>

/// Parts of texts, as the last dimension of a NumericRange selects them (Part 4, 7.27): bytes of a
/// ByteString, characters (Unicode code points) of a String, which are never cut in two. Bytes that
/// are not UTF-8 belong to the character before them.
namespace busbar::detail {

inline std::string_view bytes_of(const String& text)
{
    return text.view();
}

inline std::string_view bytes_of(const ByteString& text)
{
    return {reinterpret_cast<const char*>(text.span().data()), text.size()};
}

inline void assign(String& to, std::string_view bytes)
{
    to = String{bytes};
}

inline void assign(ByteString& to, std::string_view bytes)
{
    to = ByteString{std::as_bytes(std::span{bytes})};
}

/// Returns the offset of the character after the one at `at`.
inline std::size_t next_character(std::string_view text, std::size_t at)
{
    do {
        ++at;
    } while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U);
    return at;
}

/// Returns the offset `count` units after the one at `at`, or the text's end.
template <typename Text>
std::size_t skip(const Text& text, std::size_t at, std::uint64_t count)
{
    const std::string_view bytes = bytes_of(text);
    if constexpr (std::is_same_v<Text, ByteString>) {
        return at + static_cast<std::size_t>(std::min<std::uint64_t>(count, bytes.size() - at));
    } else {
        for (; count != 0 && at < bytes.size(); --count) {
            at = next_character(bytes, at);
        }
        return at;
    }
}

/// Returns the number of units in `text`.
template <typename Text>
std::size_t length_of(const Text& text)
{
    const std::string_view bytes = bytes_of(text);
    if constexpr (std::is_same_v<Text, ByteString>) {
        return bytes.size();
    } else {
        std::size_t length = 0;
        for (std::size_t at = 0; at < bytes.size(); at = next_character(bytes, at)) {
            ++length;
        }
        return length;
    }
}

} // namespace busbar::detail

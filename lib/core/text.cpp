#include <busbar/core/text.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "utf8.hpp"

namespace busbar {

namespace detail {

namespace {

/// Returns the length of the valid UTF-8 sequence at the front of `text`, which is not empty; 0 if
/// it is not valid.
std::size_t any_sequence(std::string_view text)
{
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned lead = byte(0);
    const std::size_t size = lead < 0x80   ? 1
                             : lead < 0xC2 ? 0
                             : lead < 0xE0 ? 2
                             : lead < 0xF0 ? 3
                             : lead < 0xF5 ? 4
                                           : 0;
    if (size == 0 || size > text.size()) {
        return 0;
    }
    for (std::size_t i = 1; i < size; ++i) {
        if ((byte(i) & 0xC0U) != 0x80U) {
            return 0;
        }
    }
    const unsigned second = size > 1 ? byte(1) : 0x80U;
    const bool too_short = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
    const bool surrogate = lead == 0xED && second >= 0xA0;
    const bool too_large = lead == 0xF4 && second >= 0x90;
    return too_short || surrogate || too_large ? 0 : size;
}

/// Returns whether 8 bytes have one that is not ASCII.
bool has_others(const char* bytes)
{
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, sizeof word);
    return (word & 0x8080'8080'8080'8080U) != 0;
}

/// Returns how many bytes at the front are ASCII, in steps of 8 while there are as many.
std::size_t ascii_prefix(std::string_view text)
{
    std::size_t at = 0;
    for (; text.size() - at >= 16; at += 16) {
        std::uint64_t words[2];
        std::memcpy(words, text.data() + at, sizeof words);
        if (((words[0] | words[1]) & 0x8080'8080'8080'8080U) != 0) {
            break;
        }
    }
    for (; text.size() - at >= 8 && !has_others(text.data() + at); at += 8) {
    }
    while (at < text.size() && static_cast<unsigned char>(text[at]) < 0x80) {
        ++at;
    }
    return at;
}

} // namespace

std::size_t utf8_sequence(std::string_view text)
{
    const std::size_t size = any_sequence(text);
    const bool is_c1_control =
        size == 2 && text[0] == '\xC2' && static_cast<unsigned char>(text[1]) < 0xA0;
    return is_c1_control ? 0 : size;
}

bool is_utf8(std::string_view text)
{
    for (;;) {
        text.remove_prefix(ascii_prefix(text));
        if (text.empty()) {
            return true;
        }
        // Texts that are not ASCII have many such sequences in a row.
        while (!text.empty() && static_cast<unsigned char>(text.front()) >= 0x80) {
            const std::size_t size = any_sequence(text);
            if (size == 0) {
                return false;
            }
            text.remove_prefix(size);
        }
    }
}

bool is_bidi_control(std::string_view sequence)
{
    if (sequence == "\xD8\x9C") { // U+061C
        return true;
    }
    if (sequence.size() != 3 || sequence[0] != '\xE2') {
        return false;
    }
    const auto last = static_cast<unsigned char>(sequence[2]);
    const bool is_mark = last == 0x8E || last == 0x8F;      // U+200E, U+200F
    const bool is_embedding = last >= 0xAA && last <= 0xAE; // U+202A to U+202E
    const bool is_isolate = last >= 0xA6 && last <= 0xA9;   // U+2066 to U+2069
    return (sequence[1] == '\x80' && (is_mark || is_embedding)) ||
           (sequence[1] == '\x81' && is_isolate);
}

namespace {

/// Returns the length of the sequence at the front; 0 if it is not valid or not printable.
std::size_t readable_sequence(std::string_view text)
{
    const auto first = static_cast<unsigned char>(text.front());
    const std::size_t size = utf8_sequence(text);
    return first < 0x20 || first == 0x7F || is_bidi_control(text.substr(0, size)) ? 0 : size;
}

} // namespace

bool is_name(std::string_view text)
{
    if (text.empty() || text.front() == ' ' || text.back() == ' ') {
        return false;
    }
    while (!text.empty()) {
        const std::size_t size = readable_sequence(text);
        if (size == 0) {
            return false;
        }
        text.remove_prefix(size);
    }
    return true;
}

std::string_view cut_short(std::string_view text, std::size_t max_bytes)
{
    std::size_t end = std::min(text.size(), max_bytes);
    while (end != text.size() && end != 0 &&
           (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) {
        --end;
    }
    return text.substr(0, end);
}

} // namespace detail

namespace {

void append_escaped(std::string& text, unsigned char byte)
{
    constexpr std::string_view digits = "0123456789ABCDEF";
    text += "\\x";
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
}

/// Appends "\u202E", for a sequence of two or three bytes.
void append_code_point(std::string& text, std::string_view sequence)
{
    constexpr std::string_view digits = "0123456789ABCDEF";
    unsigned code = static_cast<unsigned char>(sequence[0]) & (sequence.size() == 2 ? 0x1FU : 0xFU);
    for (const char byte : sequence.substr(1)) {
        code = (code << 6U) | (static_cast<unsigned char>(byte) & 0x3FU);
    }
    text += "\\u";
    for (const unsigned shift : {12U, 8U, 4U, 0U}) {
        text += digits[(code >> shift) & 15U];
    }
}

} // namespace

std::string to_string(const QualifiedName& name)
{
    if (name.namespace_index == 0) {
        return name.name.str();
    }
    return std::to_string(name.namespace_index) + ":" + name.name.str();
}

std::string printable(std::string_view text, std::size_t max_bytes)
{
    std::string result;
    while (!text.empty() && result.size() < max_bytes) {
        const std::size_t size = detail::readable_sequence(text);
        const std::size_t whole = size == 0 ? detail::utf8_sequence(text) : size;
        if (whole > 1 && size == 0) {
            append_code_point(result, text.substr(0, whole));
            text.remove_prefix(whole);
        } else if (size == 0) {
            append_escaped(result, static_cast<unsigned char>(text[0]));
            text.remove_prefix(1);
        } else {
            result += text.substr(0, size);
            text.remove_prefix(size);
        }
    }
    return text.empty() ? result : result + "...";
}

} // namespace busbar

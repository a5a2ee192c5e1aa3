#include <busbar/core/text.hpp>

#include <string>
#include <string_view>

#include "utf8.hpp"

namespace busbar {

namespace detail {

std::size_t utf8_sequence(std::string_view text)
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
    const bool c1_control = lead == 0xC2 && second < 0xA0;
    return too_short || surrogate || too_large || c1_control ? 0 : size;
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
        const auto first = static_cast<unsigned char>(text[0]);
        const std::size_t size = detail::utf8_sequence(text);
        if (size == 0 || first < 0x20 || first == 0x7F) {
            append_escaped(result, first);
            text.remove_prefix(1);
        } else {
            result += text.substr(0, size);
            text.remove_prefix(size);
        }
    }
    return text.empty() ? result : result + "...";
}

} // namespace busbar

#include "xml_text.hpp"

namespace busbar::nodeset {

namespace {

void append_utf8(std::uint32_t code, std::string& to)
{
    const auto put = [&](std::uint32_t byte) { to += static_cast<char>(byte); };
    if (code < 0x80U) {
        put(code);
    } else if (code < 0x800U) {
        put(0xC0U | code >> 6U);
        put(0x80U | (code & 0x3FU));
    } else if (code < 0x10000U) {
        put(0xE0U | code >> 12U);
        put(0x80U | (code >> 6U & 0x3FU));
        put(0x80U | (code & 0x3FU));
    } else {
        put(0xF0U | code >> 18U);
        put(0x80U | (code >> 12U & 0x3FU));
        put(0x80U | (code >> 6U & 0x3FU));
        put(0x80U | (code & 0x3FU));
    }
}

} // namespace

std::string from_utf16(std::string_view text)
{
    const bool is_little = text.starts_with("\xFF\xFE");
    if (!is_little && !text.starts_with("\xFE\xFF")) {
        return {};
    }
    constexpr std::uint32_t replacement = 0xFFFD;
    const auto unit = [&](std::size_t at) {
        const auto first = static_cast<unsigned char>(text[at]);
        const auto second = static_cast<unsigned char>(text[at + 1]);
        return static_cast<std::uint32_t>(is_little ? first | second << 8 : first << 8 | second);
    };
    std::string result;
    for (std::size_t at = 2; at + 1 < text.size(); at += 2) {
        std::uint32_t code = unit(at);
        if (code >= 0xD800U && code < 0xE000U) {
            const std::uint32_t low = at + 3 < text.size() ? unit(at + 2) : 0;
            const bool is_pair = code < 0xDC00U && low >= 0xDC00U && low < 0xE000U;
            code = is_pair ? 0x10000U + ((code - 0xD800U) << 10U) + (low - 0xDC00U) : replacement;
            at += is_pair ? 2 : 0;
        }
        append_utf8(code, result);
    }
    return result;
}

} // namespace busbar::nodeset

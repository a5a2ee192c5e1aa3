#include "json_string.hpp"

#include "core/utf8.hpp"

namespace busbar::client::detail {

namespace {

void append_escape(std::string& to, unsigned code)
{
    constexpr std::string_view digits = "0123456789abcdef";
    to += "\\u00";
    to += digits[code >> 4U & 15U];
    to += digits[code & 15U];
}

/// True for a C1 control character in UTF-8, which a terminal may obey.
bool is_c1(std::string_view text)
{
    return text.size() > 1 && text[0] == '\xC2' &&
           (static_cast<unsigned>(text[1]) & 0xE0U) == 0x80U;
}

} // namespace

void append_json_string(std::string& to, std::string_view text)
{
    to += '"';
    while (!text.empty()) {
        const auto first = static_cast<unsigned char>(text.front());
        std::size_t size = busbar::detail::utf8_sequence(text);
        if (first < 0x20 || first == 0x7F) {
            append_escape(to, first);
        } else if (first == '"' || first == '\\') {
            to += '\\';
            to += text.front();
        } else if (size != 0) {
            to += text.substr(0, size);
        } else if (is_c1(text)) {
            append_escape(to, static_cast<unsigned char>(text[1]));
            size = 2;
        } else {
            to += "\\ufffd";
            size = 1;
        }
        text.remove_prefix(size);
    }
    to += '"';
}

} // namespace busbar::client::detail

#include "json_writer.hpp"

#include "utf8.hpp"

namespace busbar::detail {

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

void JsonWriter::name(std::string_view name)
{
    string(name);
    text_ += ':';
}

void JsonWriter::string(std::string_view text)
{
    separate();
    text_ += '"';
    while (!text.empty()) {
        const auto first = static_cast<unsigned char>(text.front());
        std::size_t size = utf8_sequence(text);
        if (first < 0x20 || first == 0x7F) {
            append_escape(text_, first);
        } else if (first == '"' || first == '\\') {
            text_ += '\\';
            text_ += text.front();
        } else if (size != 0) {
            text_ += text.substr(0, size);
        } else if (is_c1(text)) {
            append_escape(text_, static_cast<unsigned char>(text[1]));
            size = 2;
        } else {
            text_ += "\\ufffd";
            size = 1;
        }
        text.remove_prefix(size);
    }
    text_ += '"';
}

void JsonWriter::word(std::string_view word)
{
    separate();
    text_ += word;
}

void JsonWriter::open(char bracket)
{
    separate();
    text_ += bracket;
}

/// Output that ends in one of these characters has just opened, named or separated something.
void JsonWriter::separate()
{
    constexpr std::string_view openings = "{[:";
    if (!text_.empty() && openings.find(text_.back()) == std::string_view::npos) {
        text_ += ',';
    }
}

} // namespace busbar::detail

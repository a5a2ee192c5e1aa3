#include "json_writer.hpp"

#include <cmath>
#include <cstdio>

#include <busbar/core/text.hpp>

namespace busbar::cli {

namespace {

/// U+0080 to U+009F, which terminals take for commands.
bool is_c1_control(std::string_view text)
{
    return text.size() > 1 && text[0] == '\xC2' && (text[1] & 0xE0) == 0x80;
}

/// The bytes of the character that `text` begins with, 0 if they are no UTF-8.
std::size_t character_size(std::string_view text)
{
    if (static_cast<unsigned char>(text[0]) < 0x80) {
        return 1;
    }
    for (std::size_t size = 2; size <= 4 && size <= text.size(); ++size) {
        const std::string_view character = text.substr(0, size);
        if (is_c1_control(character) || printable(character) == character) {
            return size;
        }
    }
    return 0;
}

void append_character(std::string& json, std::string_view character)
{
    const auto first = static_cast<unsigned char>(character[0]);
    const bool is_control = first < 0x20 || first == 0x7F || is_c1_control(character);
    if (is_control) {
        char escape[8];
        std::snprintf(escape, sizeof escape, "\\u%04x",
                      static_cast<unsigned char>(character.back()));
        json += escape;
        return;
    }
    if (character == "\"" || character == "\\") {
        json += '\\';
    }
    json += character;
}

} // namespace

void JsonWriter::separate()
{
    if (needs_comma_) {
        text_ += ',';
    }
    needs_comma_ = true;
}

JsonWriter& JsonWriter::open(char bracket)
{
    separate();
    text_ += bracket;
    needs_comma_ = false;
    return *this;
}

JsonWriter& JsonWriter::close(char bracket)
{
    text_ += bracket;
    needs_comma_ = true;
    return *this;
}

JsonWriter& JsonWriter::key(std::string_view name)
{
    text(name);
    text_ += ':';
    needs_comma_ = false;
    return *this;
}

JsonWriter& JsonWriter::text(std::string_view value)
{
    separate();
    text_ += '"';
    while (!value.empty()) {
        const std::size_t size = character_size(value);
        if (size == 0) {
            text_ += "\\ufffd";
        } else {
            append_character(text_, value.substr(0, size));
        }
        value.remove_prefix(size == 0 ? 1 : size);
    }
    text_ += '"';
    return *this;
}

JsonWriter& JsonWriter::texts(std::span<const std::string> values)
{
    open_array();
    for (const std::string& value : values) {
        text(value);
    }
    return close_array();
}

JsonWriter& JsonWriter::number(double value)
{
    if (!std::isfinite(value)) {
        return null();
    }
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    return raw(text);
}

JsonWriter& JsonWriter::raw(std::string_view json)
{
    separate();
    text_ += json;
    return *this;
}

JsonWriter& JsonWriter::member(std::string_view name, DateTime value)
{
    return value.is_null() ? key(name).null() : key(name).text(to_string(value));
}

JsonWriter& JsonWriter::member(std::string_view name, StatusCode value)
{
    key(name).open_object();
    key("code").number(static_cast<std::int64_t>(value.value()));
    if (const std::string_view symbol = busbar::name(value); !symbol.empty()) {
        member("symbol", symbol);
    }
    return close_object();
}

} // namespace busbar::cli

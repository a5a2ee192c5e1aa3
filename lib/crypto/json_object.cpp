#include "json_object.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "core/number_text.hpp"

namespace busbar::crypto::detail {

namespace {

constexpr std::size_t max_members = 64;
constexpr std::size_t max_depth = 8;

/// Walks over a text; each function moves behind what it reads, or is false and the text is none.
class Scanner {
public:
    explicit Scanner(std::string_view text) : rest_{text} {}

    void skip_space()
    {
        rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size()));
    }
    [[nodiscard]] bool is_at_end() const { return rest_.empty(); }
    [[nodiscard]] char peek() const { return rest_.empty() ? '\0' : rest_.front(); }
    /// The character and the space before and behind it.
    bool take(char c)
    {
        skip_space();
        if (peek() != c) {
            return false;
        }
        rest_.remove_prefix(1);
        skip_space();
        return true;
    }
    bool word(std::string_view expected)
    {
        if (!rest_.starts_with(expected)) {
            return false;
        }
        rest_.remove_prefix(expected.size());
        return true;
    }
    bool string(std::string& text);
    bool number(double& value);
    bool value(JsonObject::Value& value, std::size_t depth);

private:
    bool escape(std::string& text);
    bool code_unit(std::uint32_t& unit);
    bool code_point(std::string& text);
    bool array(JsonObject::Value& value, std::size_t depth);
    bool skip_object(std::size_t depth);

    std::string_view rest_;
};

void append_utf8(std::string& text, std::uint32_t code)
{
    const auto put = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
    const auto put_rest = [&](unsigned shift) { put(0x80U | (code >> shift & 0x3FU)); };
    if (code < 0x80) {
        put(code);
    } else if (code < 0x800) {
        put(0xC0U | code >> 6U);
        put_rest(0);
    } else if (code < 0x10000) {
        put(0xE0U | code >> 12U);
        put_rest(6);
        put_rest(0);
    } else {
        put(0xF0U | code >> 18U);
        put_rest(12);
        put_rest(6);
        put_rest(0);
    }
}

bool Scanner::string(std::string& text)
{
    if (!word("\"")) {
        return false;
    }
    while (!rest_.empty()) {
        const char c = rest_.front();
        rest_.remove_prefix(1);
        if (c == '"') {
            return true;
        }
        if (static_cast<unsigned char>(c) < 0x20 || (c == '\\' && !escape(text))) {
            return false;
        }
        if (c != '\\') {
            text += c;
        }
    }
    return false;
}

bool Scanner::escape(std::string& text)
{
    constexpr std::string_view codes = "\"\\/bfnrt";
    constexpr std::string_view characters = "\"\\/\b\f\n\r\t";
    if (word("u")) {
        return code_point(text);
    }
    const std::size_t index = rest_.empty() ? std::string_view::npos : codes.find(rest_.front());
    if (index == std::string_view::npos) {
        return false;
    }
    text += characters[index];
    rest_.remove_prefix(1);
    return true;
}

bool Scanner::code_unit(std::uint32_t& unit)
{
    if (rest_.size() < 4) {
        return false;
    }
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + 4, unit, 16);
    if (error != std::errc{} || end != rest_.data() + 4) {
        return false;
    }
    rest_.remove_prefix(4);
    return true;
}

bool Scanner::code_point(std::string& text)
{
    std::uint32_t code = 0;
    if (!code_unit(code) || code == 0 || (code >= 0xDC00 && code < 0xE000)) {
        return false;
    }
    if (code >= 0xD800 && code < 0xDC00) {
        std::uint32_t low = 0;
        if (!word("\\u") || !code_unit(low) || low < 0xDC00 || low >= 0xE000) {
            return false;
        }
        code = 0x10000 + ((code - 0xD800) << 10U) + (low - 0xDC00);
    }
    append_utf8(text, code);
    return true;
}

bool Scanner::number(double& value)
{
    // What from_chars takes and JSON does not: a leading zero, a lone point, "inf" and "nan".
    const std::size_t first = rest_.starts_with('-') ? 1 : 0;
    const auto is_digit = [&](std::size_t i) {
        return i < rest_.size() && rest_[i] >= '0' && rest_[i] <= '9';
    };
    if (!is_digit(first) || (rest_[first] == '0' && is_digit(first + 1))) {
        return false;
    }
    const auto [end, error] =
        busbar::detail::read_number(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc{} || end[-1] == '.' || !std::isfinite(value)) {
        return false;
    }
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return true;
}

bool Scanner::value(JsonObject::Value& value, std::size_t depth)
{
    switch (peek()) {
    case '"':
        return string(value.emplace<std::string>());
    case '[':
        return array(value, depth);
    case '{':
        return skip_object(depth);
    case 't':
        return word("true");
    case 'f':
        return word("false");
    case 'n':
        return word("null");
    default:
        return number(value.emplace<double>());
    }
}

/// Strings, or Other if anything else is among them.
bool Scanner::array(JsonObject::Value& value, std::size_t depth)
{
    JsonObject::Strings strings;
    bool are_strings = true;
    if (depth >= max_depth || !take('[')) {
        return false;
    }
    bool is_more = peek() != ']';
    while (is_more) {
        JsonObject::Value item;
        skip_space();
        if (!this->value(item, depth + 1)) {
            return false;
        }
        auto* text = std::get_if<std::string>(&item);
        are_strings = are_strings && text != nullptr;
        if (are_strings) {
            strings.push_back(std::move(*text));
        }
        is_more = take(',');
    }
    if (are_strings) {
        value = std::move(strings);
    }
    return word("]");
}

bool Scanner::skip_object(std::size_t depth)
{
    if (depth >= max_depth || !take('{')) {
        return false;
    }
    bool is_more = peek() != '}';
    while (is_more) {
        std::string name;
        JsonObject::Value ignored;
        if (!string(name) || !take(':') || !value(ignored, depth + 1)) {
            return false;
        }
        is_more = take(',');
    }
    return word("}");
}

} // namespace

std::optional<JsonObject> JsonObject::parse(std::string_view text)
{
    JsonObject object;
    Scanner scanner{text};
    if (!scanner.take('{')) {
        return std::nullopt;
    }
    bool is_more = scanner.peek() != '}';
    while (is_more) {
        auto& [name, value] = object.members_.emplace_back();
        if (!scanner.string(name) || !scanner.take(':') || !scanner.value(value, 1) ||
            object.members_.size() > max_members) {
            return std::nullopt;
        }
        // The one that stands first is found: not this one if the name is there twice.
        if (object.find<Value>(name) != &value) {
            return std::nullopt;
        }
        is_more = scanner.take(',');
    }
    if (!scanner.take('}') || !scanner.is_at_end()) {
        return std::nullopt;
    }
    return object;
}

} // namespace busbar::crypto::detail

#include "json.hpp"

#include <algorithm>
#include <cstdint>

#include <busbar/core/text.hpp>

namespace busbar::detail {

namespace {

void append_utf8(std::string& to, std::uint32_t code)
{
    const auto add = [&](std::uint32_t byte) { to += static_cast<char>(byte); };
    const auto add_rest = [&](unsigned shift) { add(0x80U | (code >> shift & 0x3FU)); };
    if (code < 0x80) {
        return add(code);
    }
    if (code < 0x800) {
        add(0xC0U | code >> 6U);
    } else {
        if (code < 0x10000) {
            add(0xE0U | code >> 12U);
        } else {
            add(0xF0U | code >> 18U);
            add_rest(12);
        }
        add_rest(6);
    }
    add_rest(0);
}

/// Returns the value of a hexadecimal digit, 16 for another character.
std::uint32_t digit_of(char c)
{
    constexpr std::string_view hexadecimal = "0123456789abcdef";
    const char lower = c >= 'A' && c <= 'F' ? static_cast<char>(c + 32) : c;
    return static_cast<std::uint32_t>(std::min(hexadecimal.find(lower), hexadecimal.size()));
}

/// Returns the number of digits at the front of `text`.
std::size_t digits_in_front(std::string_view text)
{
    return std::min(text.find_first_not_of("0123456789"), text.size());
}

/// RFC 8259, 6.
bool is_number(std::string_view word)
{
    word.remove_prefix(word.starts_with('-') ? 1 : 0);
    const std::size_t whole = digits_in_front(word);
    if (whole == 0 || (whole > 1 && word.front() == '0')) {
        return false;
    }
    word.remove_prefix(whole);
    if (word.starts_with('.')) {
        const std::size_t fraction = digits_in_front(word.substr(1));
        word.remove_prefix(fraction == 0 ? 0 : 1 + fraction);
    }
    if (word.starts_with('e') || word.starts_with('E')) {
        word.remove_prefix(1);
        word.remove_prefix(word.starts_with('+') || word.starts_with('-') ? 1 : 0);
        return !word.empty() && digits_in_front(word) == word.size();
    }
    return word.empty();
}

/// Reads from front to back and keeps the first error.
class JsonReader {
public:
    JsonReader(std::string_view text, const JsonLimits& limits) : text_{text}, limits_{limits} {}

    [[nodiscard]] Expected<Json, std::string> read()
    {
        Json json;
        if (text_.size() > limits_.max_size) {
            expect("a shorter text");
        } else {
            value(json);
            skip_space();
            if (at_ != text_.size()) {
                expect("the end");
            }
        }
        if (!error_.empty()) {
            return Unexpected{std::move(error_)};
        }
        return json;
    }

private:
    void expect(std::string_view what)
    {
        if (error_.empty()) {
            error_ = "expected " + std::string{what} + " at position " + std::to_string(at_ + 1);
        }
    }
    [[nodiscard]] bool ok() const { return error_.empty(); }
    [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    [[nodiscard]] bool take(char c)
    {
        const bool is_there = at_ < text_.size() && text_[at_] == c;
        at_ += is_there ? 1 : 0;
        return is_there;
    }
    void skip_space() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }

    void value(Json& to)
    {
        skip_space();
        if (++values_ > limits_.max_values) {
            return expect("fewer values");
        }
        if (peek() == '[' || peek() == '{') {
            nested(to);
        } else if (take('"')) {
            to.kind = Json::Kind::String;
            string(to.text);
        } else {
            word(to);
        }
    }
    void nested(Json& to)
    {
        if (depth_ == limits_.max_depth) {
            return expect("fewer levels");
        }
        ++depth_;
        take('[') ? list(to) : object(to);
        --depth_;
    }
    void list(Json& to)
    {
        to.kind = Json::Kind::List;
        skip_space();
        if (take(']')) {
            return;
        }
        do {
            value(to.items.emplace_back());
            skip_space();
        } while (ok() && take(','));
        if (!take(']')) {
            expect("',' or ']'");
        }
    }
    void object(Json& to)
    {
        to.kind = Json::Kind::Object;
        ++at_;
        skip_space();
        if (take('}')) {
            return;
        }
        do {
            name(to);
            if (ok()) {
                value(to.items.emplace_back());
                skip_space();
            }
        } while (ok() && take(','));
        if (!take('}')) {
            expect("',' or '}'");
        }
    }
    void name(Json& to)
    {
        skip_space();
        if (to.names.size() == limits_.max_members) {
            return expect("fewer members");
        }
        if (!take('"')) {
            return expect("a name in quotes");
        }
        std::string name;
        string(name);
        if (ok() && to.find(name) != nullptr) {
            return expect("each name once");
        }
        to.names.push_back(std::move(name));
        skip_space();
        if (!take(':')) {
            expect("':'");
        }
    }
    /// A number, true, false or null.
    void word(Json& to)
    {
        const std::size_t end = std::min(text_.find_first_of(" \t\r\n,]}:[{\"", at_), text_.size());
        const std::string_view word = text_.substr(at_, end - at_);
        if (word == "true" || word == "false") {
            to.kind = word == "true" ? Json::Kind::True : Json::Kind::False;
        } else if (is_number(word)) {
            to.kind = Json::Kind::Number;
            to.text = word;
        } else if (word != "null") {
            return expect("a value");
        }
        at_ = end;
    }
    void string(std::string& to)
    {
        while (ok() && !take('"')) {
            const char c = peek();
            if (at_ == text_.size() || static_cast<unsigned char>(c) < 0x20) {
                return expect("'\"'");
            }
            ++at_;
            if (c == '\\') {
                escape(to);
            } else {
                to += c;
            }
        }
    }
    void escape(std::string& to)
    {
        constexpr std::string_view names = "\"\\/bfnrt";
        constexpr std::string_view meanings = "\"\\/\b\f\n\r\t";
        const char c = peek();
        const std::size_t found = at_ < text_.size() ? names.find(c) : std::string_view::npos;
        ++at_;
        if (found != std::string_view::npos) {
            to += meanings[found];
        } else if (c == 'u') {
            unicode(to);
        } else {
            --at_;
            expect("an escape");
        }
    }
    void unicode(std::string& to)
    {
        std::uint32_t code = hexadecimal();
        if (code >= 0xD800 && code < 0xE000) {
            const bool is_first = code < 0xDC00 && take('\\') && take('u');
            const std::uint32_t low = is_first ? hexadecimal() : 0;
            if (low < 0xDC00 || low >= 0xE000) {
                return expect("both halves of a surrogate pair");
            }
            code = 0x10000 + ((code - 0xD800) << 10U) + (low - 0xDC00);
        }
        if (code == 0 && !limits_.allows_nul) {
            return expect("another character than NUL");
        }
        append_utf8(to, code);
    }
    [[nodiscard]] std::uint32_t hexadecimal()
    {
        std::uint32_t code = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const std::uint32_t digit = digit_of(peek());
            if (digit > 15) {
                expect("four hexadecimal digits");
                return 0;
            }
            code = code << 4U | digit;
            ++at_;
        }
        return code;
    }

    std::string_view text_;
    JsonLimits limits_;
    std::size_t at_{0};
    std::size_t depth_{0};
    std::size_t values_{0};
    std::string error_;
};

} // namespace

const Json* Json::find(std::string_view name) const
{
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? nullptr : &items[static_cast<std::size_t>(found - names.begin())];
}

std::string Json::describe() const
{
    constexpr std::size_t enough = 40;
    switch (kind) {
    case Kind::Null:
        return "null";
    case Kind::True:
        return "true";
    case Kind::False:
        return "false";
    case Kind::Number:
        return printable(text, enough);
    case Kind::String:
        return "\"" + printable(text, enough) + "\"";
    case Kind::List:
        return "a list";
    case Kind::Object:
        return "an object";
    }
    return {};
}

Expected<Json, std::string> parse_json(std::string_view text, const JsonLimits& limits)
{
    return JsonReader{text, limits}.read();
}

} // namespace busbar::detail

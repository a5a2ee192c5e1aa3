#include "json.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>

#include <busbar/core/text.hpp>

#include "core/number_text.hpp"

namespace busbar::client::detail {

namespace {

void append_utf8(std::string& to, std::uint32_t code)
{
    const auto add = [&](std::uint32_t byte) { to += static_cast<char>(byte); };
    if (code < 0x80) {
        add(code);
    } else if (code < 0x800) {
        add(0xC0U | code >> 6U);
        add(0x80U | (code & 0x3FU));
    } else if (code < 0x10000) {
        add(0xE0U | code >> 12U);
        add(0x80U | (code >> 6U & 0x3FU));
        add(0x80U | (code & 0x3FU));
    } else {
        add(0xF0U | code >> 18U);
        add(0x80U | (code >> 12U & 0x3FU));
        add(0x80U | (code >> 6U & 0x3FU));
        add(0x80U | (code & 0x3FU));
    }
}

/// Reads from the front to the back; the first error stays.
class JsonReader {
public:
    JsonReader(std::string_view text, const JsonLimits& limits) : text_{text}, limits_{limits} {}

    [[nodiscard]] tl::expected<Json, std::string> read()
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
            return tl::unexpected{std::move(error_)};
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
        if (depth_ == limits_.max_depth) {
            return expect("fewer levels");
        }
        ++depth_;
        if (take('[')) {
            list(to);
        } else if (take('{')) {
            object(to);
        } else if (take('"')) {
            to.kind = Json::Kind::String;
            string(to.text);
        } else {
            word(to);
        }
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
        skip_space();
        if (take('}')) {
            return;
        }
        do {
            skip_space();
            if (!take('"')) {
                return expect("a name in quotes");
            }
            string(to.names.emplace_back());
            skip_space();
            if (!take(':')) {
                return expect("':'");
            }
            value(to.items.emplace_back());
            skip_space();
        } while (ok() && take(','));
        if (!take('}')) {
            expect("',' or '}'");
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
    [[nodiscard]] static bool is_number(std::string_view word)
    {
        double ignored = 0;
        const auto [end, error] =
            busbar::detail::read_number(word.data(), word.data() + word.size(), ignored);
        const char first = word.starts_with('-') && word.size() > 1 ? word[1]
                           : word.empty()                           ? ' '
                                                                    : word[0];
        // Out of range is for the type to say; inf and nan are no numbers here.
        return error != std::errc::invalid_argument && end == word.data() + word.size() &&
               first >= '0' && first <= '9';
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
        if (code >= 0xD800 && code < 0xDC00 && take('\\') && take('u')) {
            const std::uint32_t low = hexadecimal();
            if (low >= 0xDC00 && low < 0xE000) {
                return append_utf8(to, 0x10000 + ((code - 0xD800) << 10U) + (low - 0xDC00));
            }
            code = low;
        }
        if (code >= 0xD800 && code < 0xE000) {
            return expect("both halves of a surrogate pair");
        }
        append_utf8(to, code);
    }
    [[nodiscard]] std::uint32_t hexadecimal()
    {
        std::uint32_t code = 0;
        const std::string_view digits = text_.substr(std::min(at_, text_.size()), 4);
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
        if (error != std::errc{} || end != digits.data() + 4) {
            expect("four hexadecimal digits");
        } else {
            at_ += 4;
        }
        return code;
    }

    std::string_view text_;
    JsonLimits limits_;
    std::size_t at_{0};
    std::size_t depth_{0};
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

tl::expected<Json, std::string> parse_json(std::string_view text, const JsonLimits& limits)
{
    return JsonReader{text, limits}.read();
}

} // namespace busbar::client::detail

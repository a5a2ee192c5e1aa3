#include <array>
#include <charconv>

#include "literal.hpp"
#include "text_places.hpp"

namespace busbar::controller::detail {

namespace {

struct Escape {
    char letter;
    char value;
};

/// The escapes of IEC 61131-3, 6.3.3. A new line is a line feed, as in most languages.
constexpr std::array escapes{
    Escape{'$', '$'},  Escape{'\'', '\''}, Escape{'"', '"'},  Escape{'L', '\n'}, Escape{'l', '\n'},
    Escape{'N', '\n'}, Escape{'n', '\n'},  Escape{'P', '\f'}, Escape{'p', '\f'}, Escape{'R', '\r'},
    Escape{'r', '\r'}, Escape{'T', '\t'},  Escape{'t', '\t'},
};

/// Appends a UTF-16 unit that is a whole character, as UTF-8.
void append_unit(std::string& text, unsigned unit)
{
    const auto append = [&](unsigned byte) { text += static_cast<char>(byte); };
    if (unit < 0x80) {
        append(unit);
    } else if (unit < 0x800) {
        append(0xC0U | unit >> 6U);
        append(0x80U | (unit & 0x3FU));
    } else {
        append(0xE0U | unit >> 12U);
        append(0x80U | (unit >> 6U & 0x3FU));
        append(0x80U | (unit & 0x3FU));
    }
}

/// Decodes the body of a text with its `$` escapes.
class TextBody {
public:
    TextBody(std::string_view body, bool is_wide) : body_{body}, is_wide_{is_wide} {}

    /// False if a `$` is not followed by a valid escape.
    bool read()
    {
        while (!body_.empty()) {
            const char c = body_.front();
            body_.remove_prefix(1);
            if (c != '$') {
                result_ += c;
            } else if (!read_escape()) {
                return false;
            }
        }
        return true;
    }
    [[nodiscard]] std::string& result() { return result_; }

private:
    bool read_escape()
    {
        for (const Escape& escape : escapes) {
            if (body_.starts_with(escape.letter)) {
                result_ += escape.value;
                body_.remove_prefix(1);
                return true;
            }
        }
        return read_hexadecimal();
    }
    bool read_hexadecimal()
    {
        const std::size_t digits = is_wide_ ? 4 : 2;
        if (body_.size() < digits) {
            return false;
        }
        unsigned value = 0;
        const char* end = body_.data() + digits;
        const auto [behind, error] = std::from_chars(body_.data(), end, value, 16);
        // Refuse a zero, which would end the text.
        if (error != std::errc{} || behind != end || value == 0) {
            return false;
        }
        body_.remove_prefix(digits);
        if (is_wide_) {
            append_unit(result_, value);
        } else {
            result_ += static_cast<char>(value);
        }
        return true;
    }

    std::string_view body_;
    bool is_wide_;
    std::string result_{};
};

} // namespace

LiteralResult read_text_literal(std::string_view text)
{
    const bool is_wide = text.front() == '"';
    TextBody body{text.substr(1, text.size() - 2), is_wide};
    if (!body.read()) {
        return Unexpected<std::string>{found_expected(
            text, is_wide ? "$ before $, \", ', L, N, P, R, T or four hexadecimal digits, not 0000"
                          : "$ before $, \", ', L, N, P, R, T or two hexadecimal digits, not 00")};
    }
    if (first_not_utf8(body.result())) {
        return Unexpected<std::string>{found_expected(text, "a text of UTF-8")};
    }
    return Literal{Variant{String{body.result()}}, InitialValue::Notation::Text};
}

} // namespace busbar::controller::detail

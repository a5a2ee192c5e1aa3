#include <array>
#include <charconv>
#include <optional>

#include "controller/conversion/label_text.hpp"
#include "literal.hpp"
#include "program_problem.hpp"

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
        const auto value = take_hexadecimal();
        // Refuse a zero, which would end the text.
        if (!value || *value == 0) {
            return false;
        }
        if (!is_wide_) {
            result_ += static_cast<char>(*value);
            return true;
        }
        // Half of a surrogate pair alone is told as a text that is not UTF-8.
        char32_t character = *value;
        const bool is_high = character >= 0xD800 && character < 0xDC00;
        if (const std::string_view before = body_; is_high && take_dollar()) {
            const auto low = take_hexadecimal();
            if (low && *low >= 0xDC00 && *low <= 0xDFFF) {
                character = 0x1'0000 + ((character - 0xD800) << 10U) + (*low - 0xDC00);
            } else {
                body_ = before;
            }
        }
        append_utf8(character, result_);
        return true;
    }
    bool take_dollar()
    {
        const bool is_there = body_.starts_with('$');
        body_.remove_prefix(is_there ? 1 : 0);
        return is_there;
    }
    std::optional<unsigned> take_hexadecimal()
    {
        const std::size_t digits = is_wide_ ? 4 : 2;
        if (body_.size() < digits) {
            return std::nullopt;
        }
        unsigned value = 0;
        const char* end = body_.data() + digits;
        const auto [behind, error] = std::from_chars(body_.data(), end, value, 16);
        if (error != std::errc{} || behind != end) {
            return std::nullopt;
        }
        body_.remove_prefix(digits);
        return value;
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

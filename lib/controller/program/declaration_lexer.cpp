#include "declaration_lexer.hpp"

#include <algorithm>
#include <array>

#include "core/ascii_case.hpp"

namespace busbar::controller::detail {

namespace {

bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
}

bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/// Letters of other scripts are allowed in names, because vendors allow them.
bool begins_word(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
           static_cast<unsigned char>(c) >= 0x80;
}

bool is_in_word(char c)
{
    return begins_word(c) || is_digit(c);
}

bool is_in_number(char c)
{
    return is_digit(c) || c == '_';
}

bool is_in_address(char c)
{
    return is_in_word(c) || c == '.' || c == '*' || c == '\\';
}

/// True for the prefixes of literals with hyphens between their digits.
bool is_of_date(std::string_view prefix)
{
    constexpr std::array<std::string_view, 8> prefixes{
        "D", "DATE", "DATE_AND_TIME", "DT", "LD", "LDATE", "LDATE_AND_TIME", "LDT",
    };
    return std::any_of(prefixes.begin(), prefixes.end(), [&](std::string_view each) {
        return busbar::detail::is_same_ignoring_case(each, prefix);
    });
}

} // namespace

std::string_view trimmed_text(std::string_view text)
{
    while (!text.empty() && is_blank(text.front())) {
        text.remove_prefix(1);
    }
    while (!text.empty() && is_blank(text.back())) {
        text.remove_suffix(1);
    }
    return text;
}

DeclarationToken DeclarationLexer::next()
{
    comment_ = {};
    has_comment_ = false;
    is_same_line_ = true;
    if (DeclarationToken wrong; !skip_blanks(wrong)) {
        at_ = text_.size();
        return wrong;
    }
    if (at_ == text_.size()) {
        return {DeclarationToken::Kind::End, {}, at_};
    }
    const char c = text_[at_];
    if (begins_word(c)) {
        return word();
    }
    if (is_digit(c)) {
        return number();
    }
    switch (c) {
    case '\'':
    case '"':
        return quoted();
    case '%':
        return address();
    case '{':
        return pragma();
    default:
        return symbol();
    }
}

bool DeclarationLexer::skip_blanks(DeclarationToken& wrong)
{
    while (at_ < text_.size()) {
        const char c = text_[at_];
        if (is_blank(c)) {
            is_same_line_ = is_same_line_ && c != '\n';
            ++at_;
        } else if ((c == '/' && (at(at_ + 1) == '/' || at(at_ + 1) == '*')) ||
                   (c == '(' && at(at_ + 1) == '*')) {
            if (!skip_comment(wrong)) {
                return false;
            }
        } else {
            return true;
        }
    }
    return true;
}

bool DeclarationLexer::skip_comment(DeclarationToken& wrong)
{
    constexpr std::size_t mark = 2;
    const bool is_line = text_.substr(at_, mark) == "//";
    const bool is_round = text_[at_] == '(';
    const std::size_t behind = is_line    ? text_.find('\n', at_)
                               : is_round ? block_end("(*", "*)")
                                          : block_end("/*", "*/");
    if (!is_line && behind == std::string_view::npos) {
        wrong = {DeclarationToken::Kind::Wrong,
                 is_round ? "found a comment without an end, expected '*)'"
                          : "found a comment without an end, expected '*/'",
                 at_};
        return false;
    }
    const std::size_t end = behind == std::string_view::npos ? text_.size() : behind;
    std::string_view inside = text_.substr(at_ + mark, end - at_ - mark);
    inside.remove_suffix(is_line ? 0 : mark);
    keep_comment(inside);
    is_same_line_ = is_same_line_ && inside.find('\n') == std::string_view::npos;
    at_ = end;
    return true;
}

std::size_t DeclarationLexer::block_end(std::string_view open, std::string_view close) const
{
    std::size_t depth = 0;
    std::size_t i = at_;
    while (i + 1 < text_.size()) {
        const std::string_view two = text_.substr(i, 2);
        if (two == open) {
            ++depth;
            i += 2;
        } else if (two == close) {
            --depth;
            i += 2;
            if (depth == 0) {
                return i;
            }
        } else {
            ++i;
        }
    }
    return std::string_view::npos;
}

void DeclarationLexer::keep_comment(std::string_view text)
{
    if (is_same_line_ && !has_comment_) {
        comment_ = trimmed_text(text);
        has_comment_ = true;
    }
}

DeclarationToken DeclarationLexer::word()
{
    const std::size_t end = skip_while(at_, is_in_word);
    if (at(end) != '#') {
        return take(DeclarationToken::Kind::Word, end);
    }
    const char first = at(end + 1);
    if (first != '\'' && first != '"') {
        return take(DeclarationToken::Kind::Typed,
                    typed_end(end + 1, is_of_date(text_.substr(at_, end - at_))));
    }
    const std::size_t behind = quoted_end(end + 1);
    if (behind == std::string_view::npos) {
        at_ = end + 1;
        return quoted();
    }
    return take(DeclarationToken::Kind::Typed, behind);
}

std::size_t DeclarationLexer::typed_end(std::size_t at_first, bool is_date) const
{
    std::size_t i = at_first;
    bool has_base = false;
    const auto is_between_digits = [&] {
        return i > at_first && is_digit(at(i - 1)) && is_digit(at(i + 1));
    };
    const auto is_decimal = [&] {
        const bool is_signed = at(at_first) == '-' || at(at_first) == '+';
        return is_digit(at(at_first + (is_signed ? 1 : 0))) && !has_base;
    };
    while (i < text_.size()) {
        const char c = text_[i];
        const char before = text_[i - 1];
        // Elsewhere than in a date a sign is an operator, unless it belongs to an exponent.
        const bool can_be_sign = before == '#' || (is_date && is_in_word(before)) ||
                                 ((before == 'e' || before == 'E') && is_decimal());
        const bool is_sign = (c == '-' || c == '+') && is_digit(at(i + 1)) && can_be_sign;
        if (!is_in_word(c) && c != '#' && !is_sign &&
            !((c == '.' || c == ':') && is_between_digits())) {
            break;
        }
        has_base = has_base || c == '#';
        ++i;
    }
    return i;
}

DeclarationToken DeclarationLexer::number()
{
    std::size_t end = skip_while(at_, is_in_number);
    if (at(end) == '#') {
        return take(DeclarationToken::Kind::Number, skip_while(end + 1, is_in_word));
    }
    if (at(end) == '.' && is_digit(at(end + 1))) {
        end = skip_while(end + 1, is_in_number);
    }
    if (at(end) == 'e' || at(end) == 'E') {
        const std::size_t sign = at(end + 1) == '-' || at(end + 1) == '+' ? 1 : 0;
        if (is_digit(at(end + 1 + sign))) {
            end = skip_while(end + 1 + sign, is_in_number);
        }
    }
    // A number that continues as a word is one wrong number, not a number and a word.
    return take(DeclarationToken::Kind::Number, skip_while(end, is_in_word));
}

std::size_t DeclarationLexer::quoted_end(std::size_t first) const
{
    const char quote = text_[first];
    for (std::size_t i = first + 1; i < text_.size() && text_[i] != '\n'; ++i) {
        if (text_[i] == quote) {
            return i + 1;
        }
        if (text_[i] == '$' && at(i + 1) != '\n') {
            ++i;
        }
    }
    return std::string_view::npos;
}

DeclarationToken DeclarationLexer::quoted()
{
    const std::size_t end = quoted_end(at_);
    if (end != std::string_view::npos) {
        return take(DeclarationToken::Kind::Text, end);
    }
    const std::size_t begin = at_;
    const bool is_single = text_[begin] == '\'';
    at_ = text_.size();
    return {DeclarationToken::Kind::Wrong,
            is_single ? "found a text without an end in its line, expected \"'\""
                      : "found a text without an end in its line, expected '\"'",
            begin};
}

DeclarationToken DeclarationLexer::address()
{
    return take(DeclarationToken::Kind::Address, skip_while(at_ + 1, is_in_address));
}

void DeclarationLexer::resume(const DeclarationToken& wrong)
{
    const char first = at(wrong.offset);
    const bool is_text = first == '\'' || first == '"';
    at_ = is_text ? std::min(text_.find('\n', wrong.offset), text_.size()) : text_.size();
}

std::size_t DeclarationLexer::pragma_end() const
{
    char quote = '\0';
    for (std::size_t i = at_ + 1; i < text_.size() && text_[i] != '\n'; ++i) {
        const char c = text_[i];
        if (quote != '\0') {
            quote = c == quote ? '\0' : quote;
        } else if (c == '}') {
            return i;
        } else if (c == '\'' || c == '"') {
            quote = c;
        }
    }
    // An apostrophe in prose, or a pragma of several lines.
    return text_.find('}', at_);
}

DeclarationToken DeclarationLexer::pragma()
{
    const std::size_t end = pragma_end();
    if (end == std::string_view::npos) {
        const std::size_t begin = at_;
        at_ = text_.size();
        return {DeclarationToken::Kind::Wrong, "found a pragma without an end, expected '}'",
                begin};
    }
    DeclarationToken token = take(DeclarationToken::Kind::Pragma, end + 1);
    token.text = token.text.substr(1, token.text.size() - 2);
    return token;
}

DeclarationToken DeclarationLexer::symbol()
{
    const std::string_view two = text_.substr(at_, 2);
    return take(DeclarationToken::Kind::Symbol, at_ + (two == ":=" || two == ".." ? 2 : 1));
}

std::size_t DeclarationLexer::skip_while(std::size_t first, bool (*belongs)(char)) const
{
    while (first < text_.size() && belongs(text_[first])) {
        ++first;
    }
    return first;
}

char DeclarationLexer::at(std::size_t index) const
{
    return index < text_.size() ? text_[index] : '\0';
}

DeclarationToken DeclarationLexer::take(DeclarationToken::Kind kind, std::size_t end)
{
    const DeclarationToken token{kind, text_.substr(at_, end - at_), at_};
    at_ = end;
    return token;
}

} // namespace busbar::controller::detail

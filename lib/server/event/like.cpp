#include "filter_operators.hpp"

#include <algorithm>
#include <cstdint>

namespace busbar::server::detail {

namespace {

struct Character {
    /// The code point; for a byte that is not UTF-8 a number above all code points.
    std::uint32_t code{0};
    std::size_t size{1};
};

std::size_t sequence_size(unsigned char first)
{
    if (first >= 0xF0) {
        return first < 0xF8 ? 4 : 1;
    }
    return first >= 0xE0 ? 3 : (first >= 0xC0 ? 2 : 1);
}

/// Returns the first character of a text that is not empty.
Character first_character(std::string_view text)
{
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const Character raw{byte(0) < 0x80 ? byte(0) : 0x110000U + byte(0), 1};
    const std::size_t size = sequence_size(byte(0));
    if (size == 1 || size > text.size()) {
        return raw;
    }
    std::uint32_t code = byte(0) & (0x7FU >> size);
    for (std::size_t i = 1; i < size; ++i) {
        if ((byte(i) & 0xC0U) != 0x80U) {
            return raw;
        }
        code = (code << 6U) | (byte(i) & 0x3FU);
    }
    return {code, size};
}

/// Reads a pattern or a text character by character.
class Scanner {
public:
    explicit Scanner(std::string_view text) : text_{text} {}

    [[nodiscard]] bool is_over() const { return text_.empty(); }
    [[nodiscard]] bool is_at(char c) const { return !text_.empty() && text_.front() == c; }
    bool skip(char c)
    {
        const bool is_there = is_at(c);
        text_.remove_prefix(is_there ? 1 : 0);
        return is_there;
    }
    std::uint32_t take()
    {
        const Character character = first_character(text_);
        text_.remove_prefix(character.size);
        return character.code;
    }
    /// Returns the next character unchanged, or the one after a backslash; nothing at the end.
    std::optional<std::uint32_t> take_literal()
    {
        skip('\\');
        if (is_over()) {
            return std::nullopt;
        }
        return take();
    }

private:
    std::string_view text_;
};

/// Reads a list after its '['. Nothing if it is unterminated.
std::optional<bool> is_listed(Scanner& pattern, std::uint32_t character, std::size_t& steps_left)
{
    bool is_found = false;
    const bool is_inverse = pattern.skip('^');
    while (!pattern.skip(']')) {
        steps_left -= std::min<std::size_t>(steps_left, 1);
        const auto first = pattern.take_literal();
        auto last = first;
        Scanner range = pattern;
        if (range.skip('-') && !range.is_at(']')) { // the '-' of "[a-]" stands for itself
            last = range.take_literal();
            pattern = range;
        }
        if (!first || !last) {
            return std::nullopt;
        }
        is_found = is_found || (*first <= character && character <= *last);
    }
    return is_found != is_inverse;
}

/// Compares one character of the pattern other than '%' with one of the text; advances both if they
/// fit.
bool take_one(Scanner& text, Scanner& pattern, std::size_t& steps_left)
{
    if (pattern.is_over()) {
        return false;
    }
    Scanner rest = pattern;
    Scanner behind = text;
    const std::uint32_t character = behind.take();
    bool fits = rest.skip('_');
    if (!fits) {
        fits = rest.skip('[') ? is_listed(rest, character, steps_left).value_or(false)
                              : rest.take_literal() == character;
    }
    if (fits) {
        text = behind;
        pattern = rest;
    }
    return fits;
}

} // namespace

std::optional<bool> is_like(std::string_view text, std::string_view pattern,
                            std::size_t& steps_left)
{
    Scanner at{text};
    Scanner expected{pattern};
    // The position after the last '%', whose match is made longer whenever the rest does not fit.
    // Earlier ones need no second try, since this one can match what they left.
    std::optional<Scanner> retry_at;
    Scanner retry_expected{pattern};
    while (!at.is_over()) {
        if (steps_left == 0) {
            return std::nullopt;
        }
        --steps_left;
        if (expected.skip('%')) {
            retry_at = at;
            retry_expected = expected;
        } else if (!take_one(at, expected, steps_left)) {
            if (!retry_at) {
                return false;
            }
            retry_at->take();
            at = *retry_at;
            expected = retry_expected;
        }
    }
    while (expected.skip('%')) {
    }
    return expected.is_over();
}

} // namespace busbar::server::detail

#include "toml.hpp"

#include <algorithm>
#include <optional>

namespace busbar::product {

namespace {

/// Returns the size of the comment or string at the front of `text`; 0 if there is neither. Without
/// its end it extends to the end of its line, or of the text for a multi-line string.
std::size_t length_of_free_text(std::string_view text)
{
    const char first = text.front();
    if (first == '#') {
        return std::min(text.find('\n'), text.size());
    }
    if (first != '"' && first != '\'') {
        return 0;
    }
    const bool has_lines = text.size() > 2 && text[1] == first && text[2] == first;
    const std::size_t quotes = has_lines ? 3 : 1;
    for (std::size_t i = quotes; i < text.size(); ++i) {
        if (first == '"' && text[i] == '\\') {
            ++i;
        } else if (text.substr(i, quotes) == text.substr(0, quotes)) {
            return i + quotes;
        } else if (!has_lines && text[i] == '\n') {
            return i;
        }
    }
    return text.size();
}

std::size_t line_at(std::string_view text, std::size_t at)
{
    const std::string_view before = text.substr(0, at);
    return static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1;
}

/// Finds the first byte that is not ASCII and is neither in a string nor in a comment, as far as
/// that can be told simply; toml++'s own message does not name the character.
std::optional<std::size_t> find_stray(std::string_view text)
{
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    std::size_t at = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
    while (at < text.size()) {
        if (const std::size_t length = length_of_free_text(text.substr(at)); length != 0) {
            at += length;
        } else if (static_cast<unsigned char>(text[at]) >= 0x80) {
            return at;
        } else {
            ++at;
        }
    }
    return {};
}

bool fails(std::string_view text)
{
    try {
        static_cast<void>(toml::parse(text));
    } catch (const toml::parse_error&) {
        return false; // an incomplete text is not a failure
    } catch (const TomlFailure&) {
        return true;
    }
    return false;
}

/// Finds the line of the failure. toml++ reads from the front, so more text cannot undo a failure.
std::size_t line_of_failure(std::string_view text)
{
    std::size_t least = 0;
    std::size_t most = text.size();
    while (least + 1 < most) {
        const std::size_t middle = least + (most - least) / 2;
        (fails(text.substr(0, middle)) ? most : least) = middle;
    }
    return line_at(text, most - 1);
}

} // namespace

Expected<toml::table, TomlProblem> parse_toml(std::string_view text)
{
    if (const auto stray = find_stray(text)) {
        return Unexpected{TomlProblem{line_at(text, *stray),
                                      "found a character that is not ASCII, expected it "
                                      "in strings and comments only"}};
    }
    try {
        return toml::parse(text);
    } catch (const toml::parse_error& error) {
        return Unexpected{TomlProblem{error.source().begin.line, std::string{error.description()}}};
    } catch (const TomlFailure&) {
        return Unexpected{TomlProblem{line_of_failure(text),
                                      "found text that is not TOML, expected a key, a "
                                      "[table] or a comment"}};
    }
}

} // namespace busbar::product

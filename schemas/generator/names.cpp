#include "names.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace busbar::generator {

namespace {

bool is_lower(char c)
{
    return c >= 'a' && c <= 'z';
}

bool is_upper(char c)
{
    return c >= 'A' && c <= 'Z';
}

bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

char lower(char c)
{
    return is_upper(c) ? static_cast<char>(c - 'A' + 'a') : c;
}

constexpr std::array<std::string_view, 10> digit_words = {"Zero", "One", "Two",   "Three", "Four",
                                                          "Five", "Six", "Seven", "Eight", "Nine"};

// Sorted. The last rows are members that every generated structure has.
constexpr std::string_view reserved[] = {"alignas",       "alignof",     "and",
                                         "and_eq",        "asm",         "auto",
                                         "bitand",        "bitor",       "bool",
                                         "break",         "case",        "catch",
                                         "char",          "char16_t",    "char32_t",
                                         "char8_t",       "class",       "co_await",
                                         "co_return",     "co_yield",    "compl",
                                         "concept",       "const",       "const_cast",
                                         "consteval",     "constexpr",   "constinit",
                                         "continue",      "decltype",    "default",
                                         "delete",        "do",          "double",
                                         "dynamic_cast",  "else",        "enum",
                                         "explicit",      "export",      "extern",
                                         "false",         "float",       "for",
                                         "friend",        "goto",        "if",
                                         "inline",        "int",         "long",
                                         "mutable",       "namespace",   "new",
                                         "noexcept",      "not",         "not_eq",
                                         "nullptr",       "operator",    "or",
                                         "or_eq",         "private",     "protected",
                                         "public",        "register",    "reinterpret_cast",
                                         "requires",      "return",      "short",
                                         "signed",        "sizeof",      "static",
                                         "static_assert", "static_cast", "struct",
                                         "switch",        "template",    "this",
                                         "thread_local",  "throw",       "true",
                                         "try",           "typedef",     "typeid",
                                         "typename",      "union",       "unsigned",
                                         "using",         "virtual",     "void",
                                         "volatile",      "wchar_t",     "while",
                                         "xor",           "xor_eq",      "binary_encoding_id",
                                         "min_wire_size", "type"};

std::string not_reserved(std::string name)
{
    if (std::find(std::begin(reserved), std::end(reserved), name) != std::end(reserved)) {
        name += '_';
    }
    return name;
}

/// Letters, digits and single underscores, with a letter first.
std::string identifier(std::string_view name)
{
    std::string result;
    for (const char c : name) {
        if (is_lower(c) || is_upper(c) || is_digit(c)) {
            result += c;
        } else if (!result.empty() && result.back() != '_') {
            result += '_';
        }
    }
    if (result.empty()) {
        return "Unnamed";
    }
    if (is_digit(result.front())) {
        result = std::string{digit_words[static_cast<std::size_t>(result.front() - '0')]} +
                 result.substr(1);
    }
    return result;
}

} // namespace

std::string field_name(std::string_view name)
{
    const std::string from = identifier(name);
    std::string result;
    for (std::size_t i = 0; i < from.size(); ++i) {
        // A word begins at the A of "aA" and of "AAa".
        const bool begins_word =
            i != 0 && is_upper(from[i]) &&
            (is_lower(from[i - 1]) || is_digit(from[i - 1]) ||
             (is_upper(from[i - 1]) && i + 1 < from.size() && is_lower(from[i + 1])));
        if (begins_word && result.back() != '_') {
            result += '_';
        }
        result += lower(from[i]);
    }
    return not_reserved(std::move(result));
}

std::string type_name(std::string_view name)
{
    return not_reserved(identifier(name));
}

std::string in_quotes(std::string_view text)
{
    constexpr std::string_view digits = "0123456789abcdef";
    std::string result{'"'};
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            result += '\\';
            result += c;
        } else if (byte < 0x20 || byte >= 0x7F) {
            // The pieces keep a digit that follows from joining the escape.
            result += "\\x";
            result += digits[byte >> 4U];
            result += digits[byte & 15U];
            result += "\" \"";
        } else {
            result += c;
        }
    }
    return result + '"';
}

std::string byte_table(const char* name, std::string_view bytes)
{
    constexpr std::size_t full_line = 90;
    std::string result = std::string{"constexpr char "} + name + "[] =\n";
    std::string line = "    \"";
    for (const char byte : bytes) {
        if (byte == '"' || byte == '\\') {
            line += '\\';
            line += byte;
        } else if (byte >= ' ' && byte <= '~' && byte != '?') {
            line += byte;
        } else {
            char escape[8];
            std::snprintf(escape, sizeof escape, "\\%03o", static_cast<unsigned char>(byte));
            line += escape;
        }
        if (line.size() > full_line) {
            result += line + "\"\n";
            line = "    \"";
        }
    }
    return result + line + "\";\n\n";
}

} // namespace busbar::generator

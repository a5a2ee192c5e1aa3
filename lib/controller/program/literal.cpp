#include "literal.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include <busbar/core/text.hpp>

#include "core/ascii_case.hpp"
#include "core/iec_time.hpp"
#include "core/number_text.hpp"
#include "declaration_keywords.hpp"

namespace busbar::controller::detail {

namespace {

using busbar::detail::without_underscores;
using Notation = InitialValue::Notation;

Unexpected<std::string> wrong_literal(std::string_view text, std::string_view expected)
{
    return Unexpected<std::string>{found_expected(text, expected)};
}

/// Returns an Int64 if the number fits.
LiteralResult signed_number(std::string_view text, std::uint64_t number, bool is_negative)
{
    constexpr std::uint64_t most = INT64_MAX;
    if (is_negative) {
        if (number > most + 1) {
            return wrong_literal(text, "a number of at most 64 bits");
        }
        return Literal{Variant{static_cast<std::int64_t>(std::uint64_t{0} - number)}};
    }
    return Literal{number > most ? Variant{number} : Variant{static_cast<std::int64_t>(number)}};
}

LiteralResult integer_literal(std::string_view text, std::string_view digits, int base,
                              bool is_negative)
{
    const auto plain = without_underscores(digits);
    if (!plain) {
        return wrong_literal(text, "underscores between two digits only");
    }
    std::uint64_t number = 0;
    const char* end = plain->data() + plain->size();
    const auto [behind, error] = std::from_chars(plain->data(), end, number, base);
    if (error == std::errc::result_out_of_range) {
        return wrong_literal(text, "a number of at most 64 bits");
    }
    if (error != std::errc{} || behind != end) {
        return wrong_literal(text, "a number of base " + std::to_string(base));
    }
    return signed_number(text, number, is_negative);
}

LiteralResult real_literal(std::string_view text, bool is_negative)
{
    const auto plain = without_underscores(text);
    double number = 0;
    if (plain) {
        const char* end = plain->data() + plain->size();
        const auto [behind, error] = busbar::detail::read_number(plain->data(), end, number);
        if (error == std::errc{} && behind == end && std::isfinite(number)) {
            return Literal{Variant{is_negative ? -number : number}};
        }
    }
    return wrong_literal(text, "a number that an LREAL can be");
}

LiteralResult typed_number(ElementaryType type, std::string_view text, std::string_view body)
{
    const bool is_negative = body.starts_with('-');
    const std::string_view digits = body.substr(is_negative || body.starts_with('+') ? 1 : 0);
    if (digits.empty() || digits.front() < '0' || digits.front() > '9') {
        return wrong_literal(text, "a number after the '#'");
    }
    auto number = read_number_literal(digits, is_negative);
    if (number && !number_fits(type, number->value)) {
        return wrong_literal(text, "a value of the type before the '#'");
    }
    return number;
}

LiteralResult typed_bool(std::string_view text, std::string_view body)
{
    if (busbar::detail::is_same_ignoring_case(body, "TRUE")) {
        return Literal{Variant{true}};
    }
    if (busbar::detail::is_same_ignoring_case(body, "FALSE")) {
        return Literal{Variant{false}};
    }
    return typed_number(ElementaryType::Bool, text, body);
}

template <typename T>
LiteralResult or_wrong(std::optional<T> value, Notation notation, std::string_view text,
                       std::string_view expected)
{
    if (!value) {
        return wrong_literal(text, expected);
    }
    return Literal{Variant{*value}, notation};
}

LiteralResult typed_value(ElementaryType type, std::string_view text, std::string_view body)
{
    switch (type) {
    case ElementaryType::Bool:
        return typed_bool(text, body);
    case ElementaryType::Time:
    case ElementaryType::Ltime:
        return or_wrong(busbar::detail::read_duration(body), Notation::Duration, text,
                        "a duration as T#1h2m3.5s");
    case ElementaryType::Date:
    case ElementaryType::Ldate:
        return or_wrong(busbar::detail::read_date(body), Notation::Date, text,
                        "a date from 1601 on as D#2025-12-31");
    case ElementaryType::TimeOfDay:
    case ElementaryType::LtimeOfDay:
        return or_wrong(busbar::detail::read_time_of_day(body), Notation::TimeOfDay, text,
                        "a time of day as TOD#23:59:59.5");
    case ElementaryType::DateAndTime:
    case ElementaryType::LdateAndTime:
        return or_wrong(busbar::detail::read_date_and_time(body), Notation::DateAndTime, text,
                        "a date from 1601 on and a time as DT#2025-12-31-23:59:59");
    case ElementaryType::String:
    case ElementaryType::Char:
    case ElementaryType::Wchar:
    case ElementaryType::Wstring:
        return body.starts_with('\'') || body.starts_with('"')
                   ? read_text_literal(body)
                   : wrong_literal(text, "a text in quotes after the '#'");
    default:
        return typed_number(type, text, body);
    }
}

std::optional<ElementaryType> type_of_prefix(std::string_view prefix)
{
    if (busbar::detail::is_same_ignoring_case(prefix, "T")) {
        return ElementaryType::Time;
    }
    if (busbar::detail::is_same_ignoring_case(prefix, "D")) {
        return ElementaryType::Date;
    }
    if (busbar::detail::is_same_ignoring_case(prefix, "LT")) {
        return ElementaryType::Ltime;
    }
    if (busbar::detail::is_same_ignoring_case(prefix, "LD")) {
        return ElementaryType::Ldate;
    }
    return elementary_type(prefix);
}

/// The short prefixes that Siemens has for numbers: "W#16#FF".
std::optional<ElementaryType> type_of_short_prefix(std::string_view prefix)
{
    constexpr std::array<std::pair<std::string_view, ElementaryType>, 5> rows{{
        {"B", ElementaryType::Byte},
        {"W", ElementaryType::Word},
        {"DW", ElementaryType::Dword},
        {"LW", ElementaryType::Lword},
        {"L", ElementaryType::Dint},
    }};
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const auto& row) {
        return busbar::detail::is_same_ignoring_case(row.first, prefix);
    });
    return found == rows.end() ? std::nullopt : std::optional{found->second};
}

} // namespace

std::string found_expected(std::string_view text, std::string_view what)
{
    constexpr std::size_t enough = 60;
    return "found '" + printable(text, enough) + "', expected " + std::string{what};
}

LiteralResult read_number_literal(std::string_view text, bool is_negative)
{
    const std::size_t hash = text.find('#');
    if (hash == std::string_view::npos) {
        const bool is_real = text.find_first_of(".eE") != std::string_view::npos;
        return is_real ? real_literal(text, is_negative)
                       : integer_literal(text, text, 10, is_negative);
    }
    const std::string_view base = text.substr(0, hash);
    const int radix = base == "2" ? 2 : base == "8" ? 8 : base == "16" ? 16 : 0;
    if (radix == 0) {
        return wrong_literal(text, "2#, 8# or 16#");
    }
    return integer_literal(text, text.substr(hash + 1), radix, is_negative);
}

std::optional<LiteralResult> read_typed_literal(std::string_view text)
{
    const std::size_t hash = text.find('#');
    const std::string_view prefix = text.substr(0, hash);
    const std::string_view body = text.substr(hash + 1);
    if (const auto type = type_of_prefix(prefix)) {
        return typed_value(*type, text, body);
    }
    // An enumeration may have such a name, but no value that begins with a digit or a sign.
    const std::string_view digits =
        body.substr(body.starts_with('-') || body.starts_with('+') ? 1 : 0);
    const bool is_number = !digits.empty() && digits.front() >= '0' && digits.front() <= '9';
    if (const auto type = type_of_short_prefix(prefix); type && is_number) {
        return typed_number(*type, text, body);
    }
    if (kind_of_word(prefix) == WordKind::UnknownType) {
        return wrong_literal(text, "a value of a type that is known here");
    }
    return {};
}

} // namespace busbar::controller::detail

#include "initial_checker.hpp"

#include <cmath>
#include <cstdio>

#include <busbar/core/text.hpp>

#include "declaration_keywords.hpp"
#include "program_problem.hpp"

namespace busbar::controller::detail {

namespace {

using Notation = InitialValue::Notation;

bool is_written_as(const InitialValue& value, Notation notation)
{
    return value.notation == Notation::Unknown || value.notation == notation;
}

bool is_date_as(const InitialValue& value, Notation notation)
{
    return is_written_as(value, notation) && value.value.get_if<DateTime>() != nullptr;
}

bool is_duration(const InitialValue& value)
{
    const auto* milliseconds = value.value.get_if<double>();
    return is_written_as(value, Notation::Duration) && milliseconds != nullptr &&
           std::isfinite(*milliseconds);
}

/// Counts the units of UTF-16 of a text in UTF-8.
std::size_t utf16_units_of(std::string_view text)
{
    std::size_t units = 0;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        units += byte >= 0xF0 ? 2 : (byte & 0xC0U) != 0x80U ? 1 : 0;
    }
    return units;
}

bool is_text_of(const InitialValue& value, const ResolvedType& type)
{
    const auto* text = value.value.get_if<String>();
    return is_written_as(value, Notation::Text) && text != nullptr &&
           (is_wide(type.elementary) ? utf16_units_of(text->view()) : text->size()) <=
               type.string_length &&
           !first_not_utf8(text->view());
}

/// Tells whether a number, which is in the range of its type, is within the subrange.
bool is_within(const Bounds& range, const Variant& value)
{
    if (const auto* number = value.get_if<std::int64_t>()) {
        return *number >= range.lower && *number <= range.upper;
    }
    const auto number = value.value_or(std::uint64_t{0});
    return range.upper >= 0 && number <= static_cast<std::uint64_t>(range.upper) &&
           static_cast<std::int64_t>(number) >= range.lower;
}

bool is_number_of(const InitialValue& value, const ResolvedType& type)
{
    return is_written_as(value, Notation::Number) && number_fits(type.elementary, value.value) &&
           (!type.subrange || is_within(*type.subrange, value.value));
}

std::string real_words(double number)
{
    char buffer[40]{};
    static_cast<void>(std::snprintf(buffer, sizeof buffer, "%.15g", number));
    return buffer;
}

} // namespace

bool is_of_type(const InitialValue& value, const ResolvedType& type)
{
    if (is_text(type.elementary)) {
        return is_text_of(value, type);
    }
    switch (type.elementary) {
    case ElementaryType::Bool:
        return is_written_as(value, Notation::Number) &&
               (value.value.get_if<bool>() != nullptr || is_number_of(value, type));
    case ElementaryType::Time:
    case ElementaryType::Ltime:
        return is_duration(value);
    case ElementaryType::Date:
    case ElementaryType::Ldate:
        return is_date_as(value, Notation::Date);
    case ElementaryType::TimeOfDay:
    case ElementaryType::LtimeOfDay:
        return is_date_as(value, Notation::TimeOfDay);
    case ElementaryType::DateAndTime:
    case ElementaryType::LdateAndTime:
        return is_date_as(value, Notation::DateAndTime);
    default:
        return is_number_of(value, type);
    }
}

std::string value_words(const InitialValue& value)
{
    if (const auto* number = value.value.get_if<std::int64_t>()) {
        return std::to_string(*number);
    }
    if (const auto* number = value.value.get_if<std::uint64_t>()) {
        return std::to_string(*number);
    }
    if (const auto* number = value.value.get_if<double>()) {
        return value.notation == Notation::Duration ? "T#" + real_words(*number) + "ms"
                                                    : real_words(*number);
    }
    if (const auto* truth = value.value.get_if<bool>()) {
        return *truth ? "TRUE" : "FALSE";
    }
    if (const auto* time = value.value.get_if<DateTime>()) {
        return value.notation == Notation::TimeOfDay ? "a time of day" : to_string(*time);
    }
    if (const auto* text = value.value.get_if<String>()) {
        constexpr std::size_t enough = 60;
        return value.notation == Notation::Enumerator
                   ? "the name " + printable(text->view(), enough)
                   : "a text of " + std::to_string(text->size()) + " bytes";
    }
    return "a value of another kind";
}

std::string type_words(const ResolvedType& type)
{
    std::string words = "a value of ";
    words += name(type.elementary);
    if (is_text(type.elementary) && size_of(type.elementary) == 0) {
        words += '[' + std::to_string(type.string_length) + ']';
    }
    if (type.subrange) {
        words += " (" + std::to_string(type.subrange->lower) + ".." +
                 std::to_string(type.subrange->upper) + ")";
    }
    return words;
}

} // namespace busbar::controller::detail

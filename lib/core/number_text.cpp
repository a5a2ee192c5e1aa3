#include "number_text.hpp"

#include <clocale>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

namespace busbar::detail {

namespace {

std::size_t count_digits(std::string_view text)
{
    const std::size_t end = text.find_first_not_of("0123456789");
    return end == std::string_view::npos ? text.size() : end;
}

/// Returns the length of "inf", "infinity" or "nan" at the front of `text`, in either case.
std::size_t word_length(std::string_view text)
{
    for (const std::string_view word : {"infinity", "inf", "nan"}) {
        std::size_t i = 0;
        while (i < word.size() && i < text.size() && (text[i] | 0x20) == word[i]) {
            ++i;
        }
        if (i == word.size()) {
            return i;
        }
    }
    return 0;
}

/// Returns the length of "1", "1.5", ".5", "1." at the front of `text`, with an exponent if it is
/// complete.
std::size_t decimal_length(std::string_view text)
{
    std::size_t length = count_digits(text);
    std::size_t digits = length;
    if (length < text.size() && text[length] == '.') {
        const std::size_t fraction = count_digits(text.substr(length + 1));
        digits += fraction;
        length += 1 + fraction;
    }
    if (digits == 0) {
        return 0;
    }
    if (length < text.size() && (text[length] | 0x20) == 'e') {
        std::size_t exponent = length + 1;
        if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) {
            ++exponent;
        }
        const std::size_t exponent_digits = count_digits(text.substr(exponent));
        return exponent_digits == 0 ? length : exponent + exponent_digits;
    }
    return length;
}

template <typename Number>
std::from_chars_result read(const char* first, const char* last, Number& value,
                            Number (*convert)(const char*, char**))
{
    const std::string_view all{first, static_cast<std::size_t>(last - first)};
    const std::size_t sign = all.starts_with('-') ? 1 : 0;
    const std::size_t decimal = decimal_length(all.substr(sign));
    const std::size_t length = decimal != 0 ? decimal : word_length(all.substr(sign));
    if (length == 0) {
        return {first, std::errc::invalid_argument};
    }
    std::string text{all.substr(0, sign + length)};
    const bool has_value = text.find_first_of("123456789") < text.find_first_of("eE");
    if (const std::size_t point = text.find('.'); point != std::string::npos) {
        text.replace(point, 1, std::localeconv()->decimal_point);
    }
    const Number found = convert(text.c_str(), nullptr);
    const char* const end = first + sign + length;
    if (decimal != 0 && (std::isinf(found) || (found == Number{0} && has_value))) {
        return {end, std::errc::result_out_of_range};
    }
    value = found;
    return {end, std::errc{}};
}

} // namespace

std::from_chars_result read_floating(const char* first, const char* last, double& value)
{
    return read(first, last, value, std::strtod);
}

std::from_chars_result read_floating(const char* first, const char* last, float& value)
{
    return read(first, last, value, std::strtof);
}

} // namespace busbar::detail

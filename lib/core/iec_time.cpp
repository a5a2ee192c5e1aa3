#include "iec_time.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>

#include "ascii_case.hpp"
#include "number_text.hpp"

namespace busbar::detail {

namespace {

struct DurationUnit {
    std::string_view name;
    double milliseconds;
};

/// In the order in which they follow one another.
constexpr std::array duration_units{
    DurationUnit{"d", 86'400'000}, DurationUnit{"h", 3'600'000}, DurationUnit{"m", 60'000},
    DurationUnit{"s", 1'000},      DurationUnit{"ms", 1},        DurationUnit{"us", 1e-3},
    DurationUnit{"ns", 1e-6},
};

/// Numbers of more digits say no more to a Double.
constexpr std::size_t max_digits = 18;

bool is_decimal(char c)
{
    return c >= '0' && c <= '9';
}

/// Reads from the front of a text; what is not there is nothing.
class TimeText {
public:
    explicit TimeText(std::string_view text) : text_{text} {}

    [[nodiscard]] bool empty() const { return text_.empty(); }
    bool skip(char c)
    {
        const bool is_there = text_.starts_with(c);
        text_.remove_prefix(is_there ? 1 : 0);
        return is_there;
    }
    std::string_view take_while(bool (*belongs)(char))
    {
        const auto end = std::find_if_not(text_.begin(), text_.end(), belongs);
        const auto size = static_cast<std::size_t>(end - text_.begin());
        const std::string_view taken = text_.substr(0, size);
        text_.remove_prefix(size);
        return taken;
    }
    /// A whole number of at most four digits, not above `most`.
    std::optional<unsigned> number(unsigned most)
    {
        const std::string_view digits = take_while(is_decimal);
        unsigned value = 0;
        if (digits.empty() || digits.size() > 4) {
            return {};
        }
        static_cast<void>(std::from_chars(digits.data(), digits.data() + digits.size(), value));
        return value <= most ? std::optional{value} : std::nullopt;
    }

private:
    std::string_view text_;
};

/// Reads "1.5"; nothing may follow the digits.
std::optional<double> decimal(std::string_view text)
{
    const auto plain = without_underscores(text);
    if (!plain || plain->size() > max_digits || plain->empty() || !is_decimal(plain->front()) ||
        !is_decimal(plain->back())) {
        return {};
    }
    double value = 0;
    const char* end = plain->data() + plain->size();
    const auto [behind, error] = read_number(plain->data(), end, value);
    return error == std::errc{} && behind == end ? std::optional{value} : std::nullopt;
}

bool is_in_decimal(char c)
{
    return is_decimal(c) || c == '_' || c == '.';
}

bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// One number with its unit, which is one of those from `first` on; that one is left out next time.
std::optional<double> duration_part(TimeText& text, std::size_t& first, bool& is_last)
{
    const std::string_view digits = text.take_while(is_in_decimal);
    const std::string_view unit = text.take_while(is_letter);
    const auto number = decimal(digits);
    while (first < duration_units.size() &&
           !is_same_ignoring_case(duration_units[first].name, unit)) {
        ++first;
    }
    if (!number || first == duration_units.size()) {
        return {};
    }
    is_last = digits.find('.') != std::string_view::npos;
    return *number * duration_units[first++].milliseconds;
}

std::optional<std::int64_t> day_of(TimeText& text)
{
    constexpr unsigned last_year = 9'999;
    const auto year = text.number(last_year);
    const bool has_month = text.skip('-');
    const auto month = text.number(12);
    const bool has_day = text.skip('-');
    const auto day = text.number(31);
    if (!year || !has_month || !month || !has_day || !day) {
        return {};
    }
    const std::chrono::year_month_day date{std::chrono::year{static_cast<int>(*year)},
                                           std::chrono::month{*month}, std::chrono::day{*day}};
    constexpr unsigned first_year = 1'601;
    if (!date.ok() || *year < first_year) {
        return {};
    }
    return std::chrono::sys_days{date}.time_since_epoch().count();
}

/// Reads a time of day in units of 100 ns; ignores digits of a fraction after the seventh.
std::optional<std::int64_t> ticks_of_day(TimeText& text)
{
    const auto hour = text.number(23);
    const bool has_minute = text.skip(':');
    const auto minute = text.number(59);
    if (!hour || !has_minute || !minute) {
        return {};
    }
    std::optional<unsigned> second = 0U;
    std::string fraction;
    if (text.skip(':')) {
        second = text.number(59);
        if (text.skip('.')) {
            fraction = text.take_while(is_decimal);
            if (fraction.empty()) {
                return {};
            }
        }
    }
    if (!second) {
        return {};
    }
    fraction.resize(7, '0');
    std::int64_t ticks = 0;
    static_cast<void>(std::from_chars(fraction.data(), fraction.data() + fraction.size(), ticks));
    const std::int64_t seconds = (std::int64_t{*hour} * 60 + *minute) * 60 + *second;
    return seconds * DateTime::ticks_per_second + ticks;
}

/// Leaves zeros at the end of a fraction out, and the point if nothing follows it.
std::string without_zeros(std::string text)
{
    text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) {
        text.pop_back();
    }
    return text;
}

DateTime at_day(std::int64_t day, std::int64_t ticks)
{
    constexpr std::int64_t seconds_per_day = 86'400;
    return {DateTime::from_unix_seconds(day * seconds_per_day).ticks + ticks};
}

} // namespace

std::optional<double> read_duration(std::string_view text)
{
    const bool is_negative = text.starts_with('-');
    TimeText rest{text.substr(is_negative || text.starts_with('+') ? 1 : 0)};
    double sum = 0;
    std::size_t first = 0;
    bool is_last = false;
    do {
        const auto part = is_last ? std::nullopt : duration_part(rest, first, is_last);
        if (!part) {
            return {};
        }
        sum += *part;
        // T#1h_30m is allowed, an underscore after the last part is not.
        if (rest.skip('_') && rest.empty()) {
            return {};
        }
    } while (!rest.empty());
    return is_negative ? -sum : sum;
}

std::optional<DateTime> read_date(std::string_view text)
{
    TimeText rest{text};
    const auto day = day_of(rest);
    return day && rest.empty() ? std::optional{at_day(*day, 0)} : std::nullopt;
}

std::optional<DateTime> read_time_of_day(std::string_view text)
{
    TimeText rest{text};
    const auto ticks = ticks_of_day(rest);
    return ticks && rest.empty() ? std::optional{DateTime{*ticks}} : std::nullopt;
}

std::optional<DateTime> read_date_and_time(std::string_view text)
{
    TimeText rest{text};
    const auto day = day_of(rest);
    if (!day || !rest.skip('-')) {
        return {};
    }
    const auto ticks = ticks_of_day(rest);
    return ticks && rest.empty() ? std::optional{at_day(*day, *ticks)} : std::nullopt;
}

std::optional<std::string> without_underscores(std::string_view text)
{
    const auto is_digit = [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
    };
    std::string plain;
    plain.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '_') {
            plain += text[i];
        } else if (i == 0 || i + 1 == text.size() || !is_digit(text[i - 1]) ||
                   !is_digit(text[i + 1])) {
            return {};
        }
    }
    return plain;
}

std::string duration_text(std::int64_t nanoseconds)
{
    struct Part {
        const char* unit;
        std::uint64_t size;
    };
    constexpr std::array parts{
        Part{"d", 86'400'000'000'000},
        Part{"h", 3'600'000'000'000},
        Part{"m", 60'000'000'000},
        Part{"s", 1'000'000'000},
        Part{"ms", 1'000'000},
        Part{"us", 1'000},
        Part{"ns", 1},
    };
    const bool is_negative = nanoseconds < 0;
    std::uint64_t left = static_cast<std::uint64_t>(nanoseconds);
    left = is_negative ? 0 - left : left;
    std::string text = is_negative ? "T#-" : "T#";
    if (left == 0) {
        return text + "0s";
    }
    for (const Part& part : parts) {
        if (left >= part.size) {
            text += std::to_string(left / part.size) + part.unit;
            left %= part.size;
        }
    }
    return text;
}

std::string time_of_day_text(std::int64_t nanoseconds)
{
    constexpr std::int64_t second = 1'000'000'000;
    const std::int64_t seconds = nanoseconds / second;
    char text[48];
    std::snprintf(text, sizeof text, "TOD#%02d:%02d:%02d.%09d", static_cast<int>(seconds / 3'600),
                  static_cast<int>(seconds / 60 % 60), static_cast<int>(seconds % 60),
                  static_cast<int>(nanoseconds % second));
    return without_zeros(text);
}

std::string date_text(DateTime time)
{
    return "D#" + to_string(time).substr(0, 10);
}

std::string date_and_time_text(DateTime time)
{
    std::string text = "DT#" + to_string(time);
    text.pop_back(); // the Z
    std::replace(text.begin(), text.end(), 'T', '-');
    text[1] = 'T';
    return text;
}

} // namespace busbar::detail

#include "date_time_text.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>

namespace busbar::nodeset {

namespace {

/// Takes numbers and characters from the front of a text; after a missing one it stays bad.
class TimeText {
public:
    explicit TimeText(std::string_view text) : text_{text} {}

    [[nodiscard]] int number(std::size_t digits)
    {
        int value = 0;
        const char* const end = text_.data() + std::min(digits, text_.size());
        if (text_.size() < digits || text_.front() == '-' ||
            std::from_chars(text_.data(), end, value).ptr != end) {
            is_good_ = false;
            return 0;
        }
        text_.remove_prefix(digits);
        return value;
    }
    [[nodiscard]] bool take(char c)
    {
        const bool is_there = text_.starts_with(c);
        text_.remove_prefix(is_there ? 1 : 0);
        return is_there;
    }
    void expect(char c) { is_good_ = take(c) && is_good_; }
    /// Reads the digits after a point in ticks of 100 ns; further ones are cut off.
    [[nodiscard]] std::int64_t fraction()
    {
        std::int64_t ticks = 0;
        std::int64_t unit = DateTime::ticks_per_second;
        is_good_ = is_good_ && !text_.empty() && text_.front() >= '0' && text_.front() <= '9';
        while (!text_.empty() && text_.front() >= '0' && text_.front() <= '9') {
            unit /= 10;
            ticks += unit * (text_.front() - '0');
            text_.remove_prefix(1);
        }
        return ticks;
    }
    [[nodiscard]] bool is_good() const { return is_good_; }
    [[nodiscard]] bool is_at_end() const { return text_.empty(); }

private:
    std::string_view text_;
    bool is_good_{true};
};

/// "Z", "+02:00" or nothing, in seconds.
std::int64_t offset(TimeText& text)
{
    const bool is_plus = text.take('+');
    if (!is_plus && !text.take('-')) {
        static_cast<void>(text.take('Z'));
        return 0;
    }
    const std::int64_t hours = text.number(2);
    text.expect(':');
    const std::int64_t seconds = hours * 3600 + text.number(2) * 60;
    return is_plus ? seconds : -seconds;
}

} // namespace

std::optional<DateTime> parse_date_time(std::string_view from)
{
    TimeText text{from};
    const int year = text.number(4);
    text.expect('-');
    const int month = text.number(2);
    text.expect('-');
    const int day = text.number(2);
    int hour = 0;
    int minute = 0;
    int second = 0;
    std::int64_t ticks = 0;
    if (text.take('T')) {
        hour = text.number(2);
        text.expect(':');
        minute = text.number(2);
        text.expect(':');
        second = text.number(2);
        ticks = text.take('.') ? text.fraction() : 0;
    }
    const std::int64_t shift = offset(text);
    using namespace std::chrono;
    const year_month_day date{std::chrono::year{year},
                              std::chrono::month{static_cast<unsigned>(month)},
                              std::chrono::day{static_cast<unsigned>(day)}};
    const bool is_sound = text.is_good() && text.is_at_end() && date.ok() && hour <= 24 &&
                          minute < 60 && second <= 60;
    if (!is_sound) {
        return std::nullopt;
    }
    const std::int64_t days = sys_days{date}.time_since_epoch().count();
    const std::int64_t seconds = days * 86'400 + hour * 3600 + minute * 60 + second - shift;
    return DateTime{DateTime{DateTime::from_unix_seconds(seconds).ticks + ticks}.clamped()};
}

std::string date_time_text(DateTime time)
{
    const std::int64_t ticks = time.clamped();
    return to_string(DateTime{ticks == INT64_MAX ? DateTime::latest : ticks});
}

} // namespace busbar::nodeset

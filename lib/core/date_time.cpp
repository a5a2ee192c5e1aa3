#include <busbar/core/date_time.hpp>

#include <array>
#include <chrono>
#include <cstdio>

namespace busbar {

std::string to_string(DateTime time)
{
    using namespace std::chrono;
    const std::int64_t ticks = time.clamped() == INT64_MAX ? DateTime::latest : time.clamped();
    const std::int64_t fraction = ticks % DateTime::ticks_per_second;
    const sys_seconds second{
        seconds{(ticks - fraction - DateTime::unix_epoch) / DateTime::ticks_per_second}};
    const auto day = floor<days>(second);
    const year_month_day date{day};
    const hh_mm_ss clock{second - day};
    std::array<char, 64> buffer{};
    const int length =
        std::snprintf(buffer.data(), buffer.size(), "%04d-%02u-%02uT%02d:%02d:%02d.%07d",
                      static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                      static_cast<unsigned>(date.day()), static_cast<int>(clock.hours().count()),
                      static_cast<int>(clock.minutes().count()),
                      static_cast<int>(clock.seconds().count()), static_cast<int>(fraction));
    std::string text{buffer.data(), static_cast<std::size_t>(length)};
    while (text.back() == '0') {
        text.pop_back();
    }
    if (text.back() == '.') {
        text.pop_back();
    }
    return text + "Z";
}

} // namespace busbar

#include <busbar/net/system.hpp>

#include <chrono>
#include <cstdio>
#include <ctime>

#include <sys/resource.h>
#include <sys/timex.h>
#include <unistd.h>

namespace busbar::net {

DateTime SystemWallClock::now() const
{
    using Ticks = std::chrono::duration<std::int64_t, std::ratio<1, DateTime::ticks_per_second>>;
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    return DateTime::from_unix_ticks(std::chrono::duration_cast<Ticks>(since).count());
}

TimeZone SystemWallClock::time_zone() const
{
    const std::time_t now = std::time(nullptr);
    std::tm local{};
    if (::localtime_r(&now, &local) == nullptr) {
        return {};
    }
    constexpr long seconds_of_minute = 60;
    return {static_cast<std::int16_t>(local.tm_gmtoff / seconds_of_minute), local.tm_isdst > 0};
}

bool is_clock_synchronized()
{
    timex state{}; // modes of 0: only asks
    return ::adjtimex(&state) != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
}

void give_way()
{
    constexpr int steps = 10;
    // Applies to a thread, on Linux, although the name is process; lowering is always permitted.
    const auto thread = static_cast<id_t>(::gettid());
    ::setpriority(PRIO_PROCESS, thread, ::getpriority(PRIO_PROCESS, thread) + steps);
}

void StderrLog::write(LogLevel level, std::string_view source, std::string_view text)
{
    if (level < from_) {
        return;
    }
    static constexpr const char* names[] = {"debug", "info", "warning", "error"};
    std::fprintf(stderr, "%s: %.*s: %.*s\n", names[static_cast<int>(level)],
                 static_cast<int>(source.size()), source.data(), static_cast<int>(text.size()),
                 text.data());
}

} // namespace busbar::net

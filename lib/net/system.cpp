#include <busbar/net/system.hpp>

#include <cstdio>

namespace busbar::net {

DateTime SystemWallClock::now() const
{
    using Ticks = std::chrono::duration<std::int64_t, std::ratio<1, DateTime::ticks_per_second>>;
    return DateTime::from_unix(
        std::chrono::duration_cast<Ticks>(std::chrono::system_clock::now().time_since_epoch()));
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

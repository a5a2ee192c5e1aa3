#pragma once

#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>

namespace busbar::net {

/// The time of day. Called from any thread.
class BUSBAR_API SystemWallClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override;
    [[nodiscard]] TimeZone time_zone() const override;
};

/// True if the clock of this machine follows a time service, such as NTP or PTP, according to its
/// kernel (Part 6, 6.3). Called from any thread.
[[nodiscard]] BUSBAR_API bool is_clock_synchronized();

/// Lowers the priority of the calling thread, and of those that it creates, by 10 steps of nice(2),
/// so that a thread of ordinary priority, such as a PLC's task, goes first; the system may still
/// let it wait for some milliseconds. It cannot be undone without privileges.
BUSBAR_API void give_way();

/// Writes a line to stderr for each message of a level or above. Called from any thread.
class BUSBAR_API StderrLog final : public LogSink {
public:
    explicit StderrLog(LogLevel from = LogLevel::Info) : from_{from} {}
    void write(LogLevel level, std::string_view source, std::string_view text) override;

private:
    LogLevel from_;
};

} // namespace busbar::net

#pragma once

#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>

namespace busbar::net {

/// The time of day. Any thread.
class BUSBAR_API SystemWallClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override;
    [[nodiscard]] TimeZone time_zone() const override;
};

/// Writes a line to stderr for each message of a level or above. Any thread.
class BUSBAR_API StderrLog final : public LogSink {
public:
    explicit StderrLog(LogLevel from = LogLevel::Info) : from_{from} {}
    void write(LogLevel level, std::string_view source, std::string_view text) override;

private:
    LogLevel from_;
};

} // namespace busbar::net

#include <busbar/core/detail/guarded.hpp>

#include <busbar/core/text.hpp>

namespace busbar::detail {

void write_safely(LogSink& log, LogLevel level, std::string_view source, std::string_view text)
{
    std::string lost;
    static_cast<void>(caught(lost, [&] { log.write(level, source, text); }));
}

void record_safely(LogSink& log, const Record& record)
{
    std::string lost;
    static_cast<void>(caught(lost, [&] { log.record(record); }));
}

bool wants_safely(LogSink& log, RecordKind kind)
{
    bool is_wanted = false;
    std::string lost;
    static_cast<void>(caught(lost, [&] { is_wanted = log.wants(kind); }));
    return is_wanted;
}

void report_thrown(LogSink& log, std::string_view callback, std::string_view what)
{
    std::string lost;
    static_cast<void>(caught(lost, [&] {
        log.write(LogLevel::Error, "callback",
                  std::string{callback} + " threw: " + printable(what));
    }));
}

} // namespace busbar::detail

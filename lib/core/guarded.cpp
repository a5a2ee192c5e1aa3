#include <busbar/core/detail/guarded.hpp>

#include <algorithm>
#include <string>

#include <busbar/core/text.hpp>

namespace busbar::detail {

void ThrownText::set(std::string_view text) noexcept
{
    size_ = std::min(text.size(), max_size);
    std::copy_n(text.begin(), size_, text_);
}

void write_safely(LogSink& log, LogLevel level, std::string_view source, std::string_view text)
{
    attempt([&] { log.write(level, source, text); });
}

void record_safely(LogSink& log, const Record& record)
{
    attempt([&] { log.record(record); });
}

bool wants_safely(LogSink& log, RecordKind kind)
{
    bool is_wanted = false;
    attempt([&] { is_wanted = log.wants(kind); });
    return is_wanted;
}

void report_thrown(LogSink& log, std::string_view callback, std::string_view what)
{
    attempt([&] {
        log.write(LogLevel::Error, "callback",
                  std::string{callback} + " threw: " + printable(what));
    });
}

} // namespace busbar::detail

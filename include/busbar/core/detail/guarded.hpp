#pragma once

#include <cstddef>
#include <string_view>
#include <utility>
#if defined(__cpp_exceptions)
#include <exception>
#include <new>
#endif

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/status_codes.hpp>

/// Guards the calls of what users wrote: an exception ends the operation that the call belongs to,
/// and nothing else.
namespace busbar::detail {

/// What an exception said, as much of it as fits: to keep it needs no memory, which may be what is
/// missing.
class BUSBAR_API ThrownText {
public:
    static constexpr std::size_t max_size = 240;

    void set(std::string_view text) noexcept;
    [[nodiscard]] std::string_view view() const noexcept { return {text_, size_}; }

private:
    std::size_t size_{0};
    char text_[max_size];
};

/// Calls `function`: Good, or what became of it if it threw, with the exception's own words in
/// `what`. Bad_OutOfMemory for a failed allocation, else Bad_InternalError. Allocates nothing
/// itself and throws nothing. Compiled without exceptions it is a plain call.
template <typename Function>
[[nodiscard]] StatusCode caught(ThrownText& what, Function&& function)
{
#if defined(__cpp_exceptions)
    try {
        std::forward<Function>(function)();
    } catch (const std::bad_alloc&) {
        what.set("no memory");
        return status::Bad_OutOfMemory;
    } catch (const std::exception& e) {
        what.set(e.what());
        return status::Bad_InternalError;
    } catch (...) {
        what.set("unknown exception");
        return status::Bad_InternalError;
    }
#else
    static_cast<void>(what);
    std::forward<Function>(function)();
#endif
    return status::Good;
}

/// The same where the exception's words are of no use.
template <typename Function>
[[nodiscard]] StatusCode caught(Function&& function)
{
    ThrownText lost;
    return caught(lost, std::forward<Function>(function));
}

/// Calls what may be left undone: what it throws is lost.
template <typename Function>
void attempt(Function&& function)
{
    static_cast<void>(caught(std::forward<Function>(function)));
}

/// Takes back what was begun, in its destructor, unless keep() was called.
template <typename Function>
class Undo {
public:
    explicit Undo(Function function) : function_{std::move(function)} {}
    Undo(const Undo&) = delete;
    Undo& operator=(const Undo&) = delete;
    ~Undo()
    {
        if (is_armed_) {
            attempt(function_);
        }
    }
    void keep() { is_armed_ = false; }

private:
    Function function_;
    bool is_armed_{true};
};

/// Writes to a user's log; a line that makes it throw is lost.
BUSBAR_API void write_safely(LogSink& log, LogLevel level, std::string_view source,
                             std::string_view text);

/// Gives a record to a user's log, or asks whether it wants one; no, if it throws.
BUSBAR_API void record_safely(LogSink& log, const Record& record);
[[nodiscard]] BUSBAR_API bool wants_safely(LogSink& log, RecordKind kind);

/// Tells the log what `callback` threw.
BUSBAR_API void report_thrown(LogSink& log, std::string_view callback, std::string_view what);

/// As caught(), and tells the log. `callback` is what the user knows the function by:
/// "DataSource::read".
template <typename Function>
StatusCode guarded(LogSink& log, std::string_view callback, Function&& function)
{
    ThrownText what;
    const StatusCode status = caught(what, std::forward<Function>(function));
    if (status.is_bad()) {
        report_thrown(log, callback, what.view());
    }
    return status;
}

/// A user's log that loses the lines that make it throw.
class BUSBAR_API SafeLog final : public LogSink {
public:
    /// `log` must outlive this object.
    explicit SafeLog(LogSink& log) : log_{&log} {}

    void write(LogLevel level, std::string_view source, std::string_view text) override
    {
        write_safely(*log_, level, source, text);
    }
    void record(const Record& record) override { record_safely(*log_, record); }
    [[nodiscard]] bool wants(RecordKind kind) const override { return wants_safely(*log_, kind); }

private:
    LogSink* log_;
};

} // namespace busbar::detail

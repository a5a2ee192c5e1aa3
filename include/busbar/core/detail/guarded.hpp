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

/// Guards the calls of user code: an exception ends the operation that the call belongs to, and
/// nothing else.
namespace busbar::detail {

/// The text of an exception, as much of it as fits. Keeping it needs no memory, since memory may be
/// what is missing.
class BUSBAR_API ThrownText {
public:
    static constexpr std::size_t max_size = 240;

    void set(std::string_view text) noexcept;
    [[nodiscard]] std::string_view view() const noexcept { return {text_, size_}; }

private:
    std::size_t size_{0};
    char text_[max_size];
};

/// Calls `function` and returns Good, or the status of what it threw, with the exception's text in
/// `what`: Bad_OutOfMemory for a failed allocation, else Bad_InternalError. Allocates nothing
/// itself and does not throw. Compiled without exceptions it is a plain call.
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

/// Does the same without the exception's text.
template <typename Function>
[[nodiscard]] StatusCode caught(Function&& function)
{
    ThrownText lost;
    return caught(lost, std::forward<Function>(function));
}

/// Calls a function whose failure does not matter: exceptions are discarded.
template <typename Function>
void attempt(Function&& function)
{
    static_cast<void>(caught(std::forward<Function>(function)));
}

/// Runs `function` in its destructor, to undo what was begun, unless keep() was called.
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

/// Passes a record to a user's log, or asks whether it wants one; returns false if that throws.
BUSBAR_API void record_safely(LogSink& log, const Record& record);
[[nodiscard]] BUSBAR_API bool wants_safely(LogSink& log, RecordKind kind);

/// Reports to the log what `callback` threw.
BUSBAR_API void report_thrown(LogSink& log, std::string_view callback, std::string_view what);

/// Calls as caught() does, and reports exceptions to the log. `callback` is the name that the user
/// knows the function by: "DataSource::read".
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

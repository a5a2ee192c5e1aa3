#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/harness/scheduler.hpp>

namespace busbar::harness {

/// Keeps the log of a run, one line each: "0.012 s server: connection: ...". Beyond a size the
/// oldest lines go, which the first line then says. Called from any thread.
class BUSBAR_API LogBook final : public LogSink {
public:
    static constexpr std::size_t max_size = 1U << 20U;

    /// Lines have no time.
    LogBook() = default;
    /// Lines begin with the time of `time`, which must outlive the book.
    explicit LogBook(const Scheduler& time) : time_{&time} {}

    void write(LogLevel level, std::string_view source, std::string_view message) override
    {
        write_as({}, level, source, message);
    }
    /// Writes a line of one of several speakers, whose name precedes it unless it is empty.
    void write_as(std::string_view speaker, LogLevel level, std::string_view source,
                  std::string_view message);

    [[nodiscard]] std::string text() const;
    /// The last lines, at most so many.
    [[nodiscard]] std::string last(std::size_t lines) const;
    /// True if a line has this text.
    [[nodiscard]] bool contains(std::string_view text) const;
    void clear();

private:
    const Scheduler* time_{nullptr};
    mutable std::mutex mutex_;
    std::string text_;
    std::size_t left_out_{0};
};

/// One of those whose lines a book keeps. The book must outlive it.
class BUSBAR_API Speaker final : public LogSink {
public:
    Speaker(LogBook& book, std::string name) : book_{&book}, name_{std::move(name)} {}

    void write(LogLevel level, std::string_view source, std::string_view message) override
    {
        book_->write_as(name_, level, source, message);
    }
    [[nodiscard]] const std::string& name() const { return name_; }

private:
    LogBook* book_;
    std::string name_;
};

} // namespace busbar::harness

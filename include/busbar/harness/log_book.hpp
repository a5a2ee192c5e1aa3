#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/log.hpp>
#include <busbar/harness/scheduler.hpp>

namespace busbar::harness {

/// Returns a time since the world began, as logs and traces have it: "0.012 s".
[[nodiscard]] inline std::string text_of(Duration time)
{
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(time).count();
    const std::string rest = std::to_string(1'000 + ms % 1'000);
    return std::to_string(ms / 1'000) + "." + rest.substr(1) + " s";
}

/// Keeps the log of a run, one line each: "0.012 s server: connection: ...". Beyond a size the
/// oldest lines go, which the first line then says. Called from any thread. In the header, for
/// programs without the rest of the harness.
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
    void write_as(std::string_view speaker, LogLevel, std::string_view source,
                  std::string_view message)
    {
        const std::string time =
            time_ != nullptr ? text_of(time_->now().time_since_epoch()) + " " : "";
        const bool has_speaker = !speaker.empty() && speaker != source;
        const std::lock_guard lock{mutex_};
        text_.append(time).append(has_speaker ? speaker : "").append(has_speaker ? ": " : "");
        text_.append(source).append(": ").append(message).append("\n");
        if (text_.size() > max_size) {
            const std::size_t end = text_.find('\n', text_.size() / 2) + 1;
            for (std::size_t at = 0; at < end; at = text_.find('\n', at) + 1) {
                ++left_out_;
            }
            text_.erase(0, end);
        }
    }

    [[nodiscard]] std::string text() const
    {
        const std::lock_guard lock{mutex_};
        return left_out_ == 0 ? text_ : std::to_string(left_out_) + " older lines\n" + text_;
    }
    /// The last lines, at most so many.
    [[nodiscard]] std::string last(std::size_t lines) const
    {
        const std::lock_guard lock{mutex_};
        std::size_t begin = text_.size();
        while (lines > 0 && begin > 0) {
            const std::size_t end = begin < 2 ? std::string::npos : text_.rfind('\n', begin - 2);
            begin = end == std::string::npos ? 0 : end + 1;
            --lines;
        }
        return text_.substr(begin);
    }
    /// True if a line has this text.
    [[nodiscard]] bool contains(std::string_view text) const
    {
        const std::lock_guard lock{mutex_};
        return text_.find(text) != std::string::npos;
    }
    void clear()
    {
        const std::lock_guard lock{mutex_};
        text_.clear();
        left_out_ = 0;
    }

private:
    const Scheduler* time_{nullptr};
    mutable std::mutex mutex_;
    std::string text_;
    std::size_t left_out_{0};
};

/// One of those whose lines a book keeps. The book must outlive it.
class BUSBAR_API Speaker final : public LogSink {
public:
    /// Creates one whose lines begin with `name`.
    Speaker(LogBook& book, std::string name) : book_{&book}, name_{std::move(name)} {}

    void write(LogLevel level, std::string_view source, std::string_view message) override
    {
        book_->write_as(name_, level, source, message);
    }
    /// The name before its lines.
    [[nodiscard]] const std::string& name() const { return name_; }

private:
    LogBook* book_;
    std::string name_;
};

} // namespace busbar::harness

#pragma once

#include <mutex>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>

namespace busbar::harness {

/// Keeps the log, one line each, up to a size; later lines are dropped. Called from any thread.
class BUSBAR_API LogBook final : public LogSink {
public:
    static constexpr std::size_t max_size = 1U << 20U;

    void write(LogLevel, std::string_view source, std::string_view message) override
    {
        const std::lock_guard lock{mutex_};
        if (text_.size() + source.size() + message.size() < max_size) {
            text_.append(source).append(": ").append(message).append("\n");
        }
    }
    [[nodiscard]] std::string text() const
    {
        const std::lock_guard lock{mutex_};
        return text_;
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
    }

private:
    mutable std::mutex mutex_;
    std::string text_;
};

} // namespace busbar::harness

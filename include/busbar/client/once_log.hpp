#pragma once

#include <cstddef>
#include <mutex>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>

namespace busbar::client {

/// Passes each text on once, so that repeated attempts do not fill the log. Called from any thread.
class BUSBAR_API OnceLog final : public LogSink {
public:
    /// Maximum number of texts that are remembered; further new ones are dropped until forget().
    static constexpr std::size_t max_texts = 64;

    /// `log` must outlive the object.
    explicit OnceLog(LogSink& log) : log_{&log} {}

    void write(LogLevel level, std::string_view source, std::string_view text) override;
    /// Allows all texts to be logged again, since something has changed.
    void forget();

private:
    LogSink* log_;
    std::mutex mutex_;
    /// Hashes, since texts of a peer may be long.
    std::vector<std::size_t> told_;
};

} // namespace busbar::client

#pragma once

#include <cstddef>
#include <mutex>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>

namespace busbar::client {

/// Passes each text on once, so that what is tried again and again does not fill the log. Any
/// thread.
class BUSBAR_API OnceLog final : public LogSink {
public:
    /// How many texts are told apart; further new ones are dropped until forget().
    static constexpr std::size_t max_texts = 64;

    /// `log` must outlive the object.
    explicit OnceLog(LogSink& log) : log_{&log} {}

    void write(LogLevel level, std::string_view source, std::string_view text) override;
    /// Something has changed: everything may be logged again.
    void forget();

private:
    LogSink* log_;
    std::mutex mutex_;
    /// Hashes: texts of a peer may be long.
    std::vector<std::size_t> told_;
};

} // namespace busbar::client

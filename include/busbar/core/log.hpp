#pragma once

#include <cstdint>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar {

/// The importance of a line to an operator.
enum class LogLevel : std::uint8_t { Debug, Info, Warning, Error };
enum class RecordKind : std::uint8_t;
struct Record;

/// Receives what an operator may want to know. It is never given a secret; texts from peers have
/// passed `printable`.
class BUSBAR_API LogSink {
public:
    LogSink() = default;
    LogSink(const LogSink&) = delete;
    LogSink& operator=(const LogSink&) = delete;
    virtual ~LogSink() = default;

    /// `source` is the layer or part ("channel", "session"). Called from any thread; must not block
    /// for long and must not call back into the library. A line that makes it throw is lost.
    virtual void write(LogLevel level, std::string_view source, std::string_view text) = 0;

    /// Takes a typed record of a kind that the sink wants; its line is written as well. Called as
    /// `write` is. The sink must limit what it keeps: peers can cause any number of records.
    virtual void record(const Record&) {}
    /// True for kinds of which `record` is to be called.
    [[nodiscard]] virtual bool wants(RecordKind) const { return false; }
};

/// A log that drops everything.
class BUSBAR_API NullLog final : public LogSink {
public:
    void write(LogLevel, std::string_view, std::string_view) override {}
};

} // namespace busbar

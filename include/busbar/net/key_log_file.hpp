#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include <busbar/channel/key_log.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>

namespace busbar::net {

/// A KeyLog in a file that only its owner may read, for Wireshark's preference opcua.debug_file.
/// Lines are appended; several processes may share a file. Called from any thread. For test benches
/// only: it exists only in builds with BUSBAR_KEY_LOG.
class BUSBAR_API KeyLogFile final : public channel::KeyLog {
public:
    /// Opens or creates the file, and reports that to `log`, which must outlive it, as an error: a
    /// machine that discloses its keys must not be overlooked. Bad_ConfigurationError, with the
    /// reason in the log, if it cannot be written, is a link or not a file, or is open to other
    /// users than its owner.
    [[nodiscard]] static Result<std::unique_ptr<KeyLogFile>> open(const std::string& path,
                                                                  LogSink& log);
    ~KeyLogFile() override;

    /// Lines that cannot be written are lost, with an error in the log.
    void write(std::string_view lines) override;

private:
    KeyLogFile(int file, LogSink& log) : file_{file}, log_{&log} {}

    std::mutex mutex_; // keeps lines of two channels apart
    int file_;
    LogSink* log_;
};

} // namespace busbar::net

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
/// Lines are appended; several processes may share a file. Any thread. For test benches only: it
/// exists in builds with BUSBAR_KEY_LOG alone.
class BUSBAR_API KeyLogFile final : public channel::KeyLog {
public:
    /// Opens the file or makes it, and says so in `log`, which must outlive it, as an error: nobody
    /// is to overlook that a machine gives its keys away. Bad_ConfigurationError, with the reason
    /// in the log, if it cannot be written, is a link or no file, or is open to others than its
    /// owner.
    [[nodiscard]] static Result<std::unique_ptr<KeyLogFile>> open(const std::string& path,
                                                                  LogSink& log);
    ~KeyLogFile() override;

    /// Lines that cannot be written are lost, with an error in the log.
    void write(std::string_view lines) override;

private:
    KeyLogFile(int file, LogSink& log) : file_{file}, log_{&log} {}

    std::mutex mutex_; // lines of two channels do not mix
    int file_;
    LogSink* log_;
};

} // namespace busbar::net

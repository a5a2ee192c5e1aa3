#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <busbar/controller/execution_log_reader.hpp>

#include "remote_files.hpp"

namespace busbar::tool::admin {

/// The execution log of a server, which shares its files in the folder "ExecutionLog" (W588, 7-2).
/// All functions throw Failure.
class RemoteLog {
public:
    /// Finds the log; if it is missing the Failure says what to do.
    explicit RemoteLog(Connection& connection);

    /// Lists its files, oldest first, at most the last hundred; ignores other files in the folder.
    [[nodiscard]] std::vector<NamedChild> files();
    [[nodiscard]] std::string fetch(const NamedChild& file, std::uint64_t offset = 0);
    /// Has the controller begin a new file, and lists the others, which can be removed.
    [[nodiscard]] std::vector<NamedChild> complete_files();
    void remove(const NamedChild& file);

    /// Returns the last matching entries, at most `count`.
    [[nodiscard]] controller::ExecutionLogContents
    last(const controller::ExecutionLogFilter& filter, std::size_t count);
    /// Called with whole lines, and with the number of records that are missing before them: their
    /// file was removed before it was fetched.
    using Show = std::function<void(const std::string& text, std::size_t missing)>;
    /// Fetches what was added since last(), or since the previous call, file by file.
    void fetch_new(const Show& show);

private:
    /// The same; nothing if the file was removed after it was listed.
    [[nodiscard]] std::string fetch_if_there(const NamedChild& file, std::uint64_t offset = 0);
    [[nodiscard]] controller::ExecutionLogContents
    last_of(const std::vector<NamedChild>& files, const controller::ExecutionLogFilter& filter,
            std::size_t count);
    void fetch_new_of_current(const NamedChild& file, const Show& show);
    void pass(const std::string& text, const Show& show);

    Connection& connection_;
    NodeId folder_;
    /// The position reached: all files up to this one, and so much of the next one.
    std::string newest_full_;
    std::uint64_t offset_{0};
    /// True if that file has become shorter.
    bool is_shorter_{false};
    /// Belongs to the last record so far.
    std::optional<std::uint16_t> serial_number_;
};

} // namespace busbar::tool::admin

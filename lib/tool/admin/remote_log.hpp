#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <busbar/controller/execution_log_reader.hpp>

#include "remote_files.hpp"

namespace busbar::tool::admin {

/// The execution log of a server, which shares its files as the folder "ExecutionLog" (W588,
/// 7-2). All of it throws Failure.
class RemoteLog {
public:
    /// Where it is; the failure says what to do if it is not there.
    explicit RemoteLog(Connection& connection);

    /// Its files, the oldest first; other ones in the folder are left out, and those before the
    /// last hundred.
    [[nodiscard]] std::vector<NamedChild> files();
    [[nodiscard]] std::string fetch(const NamedChild& file, std::uint64_t offset = 0);
    void remove(const NamedChild& file);

    /// The last entries that match, at most `count`.
    [[nodiscard]] controller::ExecutionLogContents
    last(const controller::ExecutionLogFilter& filter, std::size_t count);
    /// Whole lines that came since last(), or since the call before, file by file.
    void fetch_new(const std::function<void(const std::string&)>& show);

private:
    /// The same; nothing if it is gone since it was listed.
    [[nodiscard]] std::string fetch_if_there(const NamedChild& file, std::uint64_t offset = 0);
    [[nodiscard]] controller::ExecutionLogContents
    last_of(const std::vector<NamedChild>& files, const controller::ExecutionLogFilter& filter,
            std::size_t count);
    void fetch_new_of_current(const NamedChild& file,
                              const std::function<void(const std::string&)>& show);

    Connection& connection_;
    NodeId folder_;
    /// How far it was read: all files up to this one, and so much of the one behind it.
    std::string newest_full_;
    std::uint64_t offset_{0};
    /// That one has become shorter.
    bool is_shorter_{false};
};

} // namespace busbar::tool::admin

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/limits.hpp>

namespace busbar::server {

class ProcessImage;

/// The unit of a limit's number.
enum class LimitUnit : std::uint8_t { Count, Bytes, Milliseconds };

/// A limit, and what peers can make a server hold because of it.
struct MemoryRow {
    /// The name in ServerLimits: "max_sessions", "subscriptions.max_memory". Static.
    std::string_view limit;
    /// The limit in force.
    std::uint64_t value{0};
    LimitUnit unit{LimitUnit::Count};
    /// The maximum number at a time, and the maximum memory of each; 0 if another limit accounts
    /// for it, or if it holds nothing.
    std::uint64_t count{0};
    std::uint64_t bytes_each{0};
    /// The objects that are held, or the limit that accounts for them; empty if there are none.
    /// Static.
    std::string_view held;

    /// Bytes of all of them; the largest number if they are more.
    [[nodiscard]] BUSBAR_API std::uint64_t bytes() const;
};

/// Properties of a server beyond its limits.
struct MemoryAssumptions {
    /// Passwords that are hashed at a time: 1 with PasswordUsers, on any thread; 0 if no user logs
    /// in with a password.
    std::size_t password_checks{1};
    /// The cost of each of them: PasswordRules::cost, or that of the costliest existing hash
    /// (crypto::cost_of).
    crypto::PasswordCost password_cost{};
    /// There is a ServerEnvironment::channel_worker, which has copies of what it works on.
    bool has_channel_worker{false};
    /// The options of sources that do not complete their batches inline. They must outlive the
    /// call.
    std::span<const DataSourceOptions> slow_sources{};
    /// Images for which Write requests wait, and whose structures Reads and sampling encode. They
    /// must outlive the call; variables that are added later are not counted.
    std::span<const ProcessImage* const> images{};
    /// Bytes that the program holds for each connection; 64 KiB in net::ServerLoop.
    std::size_t connection_bytes{0};
};

/// The memory that a server may need, limit by limit.
struct WorstCaseMemory {
    /// In the order of ServerLimits, each limit once or more; followed by objects without a limit.
    std::vector<MemoryRow> rows;

    /// Bytes of all rows; the largest number if it is more.
    [[nodiscard]] BUSBAR_API std::uint64_t total() const;
};

/// Returns what all peers together can make a server hold with these limits, in the worst case: the
/// sum of what is on the heap at a time, without the allocator's overhead. It is an upper bound,
/// and a high one: using everything up at once takes many logged-in peers.
///
/// It does not include the server's own address space and users, nor the values of its data
/// sources: a Read holds those of all its nodes until it is answered.
[[nodiscard]] BUSBAR_API WorstCaseMemory worst_case_memory(const ServerLimits& limits,
                                                           const MemoryAssumptions& other = {});

/// Returns the largest limits whose worst case is at most `memory` bytes. All limits that hold
/// memory, or are a share of one that does, are in one proportion between those of
/// small_controller_limits() and the defaults; times are the defaults'. A firmware calls it with
/// its constant. Fails for less memory than small_controller_limits() needs.
[[nodiscard]] BUSBAR_API Configured<ServerLimits> limits_for(std::uint64_t memory,
                                                             const MemoryAssumptions& other = {});

} // namespace busbar::server

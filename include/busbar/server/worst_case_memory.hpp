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

/// What the number of a limit counts.
enum class LimitUnit : std::uint8_t { Count, Bytes, Milliseconds };

/// A limit, and what peers can make a server hold because of it.
struct MemoryRow {
    /// As ServerLimits has it: "max_sessions", "subscriptions.max_memory". Static.
    std::string_view limit;
    /// The limit as it is in force.
    std::uint64_t value{0};
    LimitUnit unit{LimitUnit::Count};
    /// How many there can be at a time, and what each takes at most; 0 if it is paid for by another
    /// limit, or holds nothing.
    std::uint64_t count{0};
    std::uint64_t bytes_each{0};
    /// What is held, or which limit pays for it; empty if nothing is. Static.
    std::string_view held;

    /// Of all of them; the largest number if they are more.
    [[nodiscard]] BUSBAR_API std::uint64_t bytes() const;
};

/// What a server has besides its limits.
struct MemoryAssumptions {
    /// Passwords that are hashed at a time: 1 with PasswordUsers, on whichever thread; 0 where
    /// nobody logs in with a password.
    std::size_t password_checks{1};
    /// What each of them costs: PasswordRules::cost, or what the costliest of the hashes that there
    /// are does (crypto::cost_of).
    crypto::PasswordCost password_cost{};
    /// There is a ServerEnvironment::channel_worker, which has copies of what it works on.
    bool has_channel_worker{false};
    /// Of the sources that do not complete their batches inline. They must outlive the call.
    std::span<const DataSourceOptions> slow_sources{};
    /// For which Write requests wait, and whose structures Reads and sampling turn into what is on
    /// the wire. They must outlive the call; variables that are added later are not counted.
    std::span<const ProcessImage* const> images{};
    /// What drives the server holds for each connection; net::ServerLoop has 64 KiB.
    std::size_t connection_bytes{0};
};

struct WorstCaseMemory {
    /// In the order of ServerLimits, each limit once or more; then what has no limit there.
    std::vector<MemoryRow> rows;

    /// Of all rows; the largest number if it is more.
    [[nodiscard]] BUSBAR_API std::uint64_t total() const;
};

/// What peers together can make a server hold with these limits, at worst: the sum of what lies on
/// the heap at a time, without what the allocator adds. It is an upper bound, and a high one: that
/// all is used up at once takes many peers who are logged in.
///
/// Not in it are the server's own address space and users, and the values that its data sources
/// give: a Read holds those of all its nodes until it is answered.
[[nodiscard]] BUSBAR_API WorstCaseMemory worst_case_memory(const ServerLimits& limits,
                                                           const MemoryAssumptions& other = {});

/// The largest limits with which that is at most `memory` bytes. All that hold memory, or are a
/// share of what does, lie in one proportion between those of small_controller_limits() and the
/// defaults; times are the defaults'. A firmware calls it with its constant. Refused: less than
/// small_controller_limits() needs.
[[nodiscard]] BUSBAR_API Configured<ServerLimits> limits_for(std::uint64_t memory,
                                                             const MemoryAssumptions& other = {});

} // namespace busbar::server

#pragma once

#include <cstddef>
#include <vector>

#include <busbar/core/result.hpp>

namespace busbar::bench {

/// What is done to the server, which is one of our own in a process of its own.
struct SessionMemoryOptions {
    /// Servers, each with so many sessions, every one over a connection of its own.
    std::vector<std::size_t> sessions{1, 10, 100, 1'000};
    /// Monitored items of each session, in one Subscription, with two Publish requests that wait.
    std::size_t items{50};
    /// Reads of a flood that each session sends before it takes an answer, and values of one Read.
    std::size_t reads{20};
    std::size_t values{1'000};
    /// Over Basic256Sha256, SignAndEncrypt.
    bool is_secure{false};
};

/// Memory of one server in megabytes, without the pages of its program.
struct SessionMemory {
    std::size_t sessions{0};
    double empty_mb{0};
    /// With sessions alone, then with their items.
    double sessions_mb{0};
    double items_mb{0};
    /// At most while every session reads, when all answers were taken, and at last when all
    /// sessions have gone.
    double peak_mb{0};
    double flooded_mb{0};
    double left_mb{0};

    /// Kilobytes that a session takes of it.
    [[nodiscard]] double each_kb(double own_mb) const
    {
        return (own_mb - empty_mb) * 1e3 / static_cast<double>(sessions);
    }
};

/// Grows the sessions of each server, and measures its memory. Before this process has
/// threads.
[[nodiscard]] Result<std::vector<SessionMemory>>
measure_session_memory(const SessionMemoryOptions& options);

/// Prints a table for people, or a JSON object.
void print(const std::vector<SessionMemory>& rows, bool json);

} // namespace busbar::bench

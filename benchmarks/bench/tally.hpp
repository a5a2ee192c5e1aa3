#pragma once

#include <atomic>
#include <cstddef>

namespace busbar::bench {

/// What the attackers of one attack have in common. Any thread.
struct Tally {
    std::atomic<bool> is_over{false};
    /// The attackers have nothing more to do.
    std::atomic<bool> is_done{false};
    std::atomic<std::size_t> answered{0};
    std::atomic<std::size_t> refused{0};
};

} // namespace busbar::bench

#pragma once

#include <cstddef>
#include <vector>

#include <busbar/core/problem.hpp>

#include "startup.hpp"

namespace busbar::bench {

/// Numbers of variables, in ascending order; all are INT, as in the manual (W588, A-1-1).
struct StartupOptions {
    /// With the limits of NJ501, of which 10,000 variables are the most.
    std::vector<std::size_t> limited{100, 1'000, 10'000};
    /// Without limits.
    std::vector<std::size_t> open{100'000};
    /// Starts of each; the fastest counts.
    int rounds{3};
};

/// Starts machines in this process, each with its execution log. Bad_InvalidArgument if the numbers
/// do not grow.
[[nodiscard]] Configured<std::vector<StartupPoint>> measure_startup(const StartupOptions& options);

} // namespace busbar::bench

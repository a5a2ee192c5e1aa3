#pragma once

#include <cstddef>
#include <vector>

#include <busbar/core/result.hpp>

#include "series.hpp"

namespace busbar::bench {

/// How many of each there are, in ascending order.
struct GrowthOptions {
    std::vector<std::size_t> sessions{1, 3, 10, 30, 100, 300, 1'000};
    std::vector<std::size_t> items{1'000, 3'000, 10'000, 30'000, 100'000, 300'000};
    std::vector<std::size_t> variables{1'000, 3'000, 10'000, 30'000, 100'000, 300'000, 1'000'000};
    /// Reads of one value that a figure is the mean of; the best of some figures is taken.
    std::size_t reads{5'000};
};

/// What creating one more costs a server, and one Read of one value, beside ever more sessions,
/// monitored items and variables, and of items what deleting one costs; each in a server of its own
/// in this process.
[[nodiscard]] Result<std::vector<Series>> measure_growth(const GrowthOptions& options);

} // namespace busbar::bench

#include "statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace busbar::timing {

Summary summarize(Times times)
{
    Summary summary;
    summary.count = times.size();
    const auto count = static_cast<double>(times.size());
    std::sort(times.begin(), times.end());
    summary.median = times[times.size() / 2];
    summary.mean = std::accumulate(times.begin(), times.end(), 0.0) / count;
    for (const double time : times) {
        summary.variance += (time - summary.mean) * (time - summary.mean) / (count - 1);
    }
    return summary;
}

double quantile(const std::vector<Times>& classes, double share)
{
    Times all;
    for (const Times& times : classes) {
        all.insert(all.end(), times.begin(), times.end());
    }
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(all.size() - 1));
    std::nth_element(all.begin(), all.begin() + at, all.end());
    return all[static_cast<std::size_t>(at)];
}

double welch_t(const Summary& a, const Summary& b)
{
    const double error = std::sqrt(a.variance / static_cast<double>(a.count) +
                                   b.variance / static_cast<double>(b.count));
    return error > 0 ? (a.mean - b.mean) / error : 0;
}

} // namespace busbar::timing

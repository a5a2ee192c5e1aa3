#pragma once

#include <cstddef>
#include <vector>

namespace busbar::timing {

/// The times of one class of inputs, in microseconds.
using Times = std::vector<double>;

struct Summary {
    std::size_t count{0};
    double median{0};
    double mean{0};
    double variance{0};
};

/// Of at least two times.
[[nodiscard]] Summary summarize(Times times);

/// What that share of all times together does not exceed. Longer ones are not looked at: there the
/// operating system was at work.
[[nodiscard]] double quantile(const std::vector<Times>& classes, double share);

/// Welch's t: how many standard errors the means of two classes are apart. Beyond 4.5 it is no
/// chance any more (the threshold of ISO/IEC 17825 and of "dude, is my code constant time?").
[[nodiscard]] double welch_t(const Summary& a, const Summary& b);
inline constexpr double threshold = 4.5;

} // namespace busbar::timing

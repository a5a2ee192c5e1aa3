#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <busbar/core/expected.hpp>

namespace busbar::bench {

/// One figure of one load, of two runs.
struct Compared {
    std::string load;
    /// As JSON has it: "median_us", "server_us".
    std::string figure;
    /// Medians of all rounds.
    double before{0};
    double after{0};
    /// After to before, round by round: those that both runs have.
    std::vector<double> ratios;
    /// The median of these.
    double ratio{0};
};

/// Compares the loads that both files have, as --json printed them: what a request costs, which is
/// better if it is less. The error says which file cannot be read and where in it.
[[nodiscard]] Expected<std::vector<Compared>, std::string> compare(const std::string& before,
                                                                   const std::string& after);
void print(const std::vector<Compared>& lines);

} // namespace busbar::bench

#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace busbar::bench {

/// Figures of models of growing size, and how each figure grows from one size to the next.
class GrowthTable {
public:
    /// A size; the figures that follow are of it.
    void begin_size(std::uint32_t size) { sizes_.push_back(size); }
    /// Every size has the same figures in the same order. What a whole model costs is given for
    /// each node, so that a growth of 1 is linear and one of the sizes' own ratio quadratic.
    void add(const std::string& figure, double value);
    void print(const char* title) const;

private:
    struct Row {
        std::string figure;
        std::vector<double> values;
    };
    std::vector<std::uint32_t> sizes_;
    std::vector<Row> rows_;
};

/// The most that was resident since forget_peak(), in MB.
[[nodiscard]] double peak_megabytes();

/// Also gives back what is free, so that it does not count as there before.
void forget_peak();

} // namespace busbar::bench

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace busbar::bench {

/// What one costs where there are so many, in microseconds.
struct Point {
    std::size_t count{0};
    /// To create one more, on the way from the point before.
    double create_us{0};
    /// To read one value.
    double read_us{0};
    /// To delete one, on the way back to the point before; 0 where that is not measured.
    double delete_us{0};
};

/// Figures of ever more of something.
struct Series {
    /// Of what, in the plural.
    std::string of;
    std::vector<Point> points;
};

/// Beyond this a cost grows with the number, and does not only differ.
constexpr double step_growth = 1.5;

/// Two neighbours of which the second costs more than step_growth times as much as the first.
struct Step {
    std::string of;
    /// "create", "read" or "delete".
    std::string cost;
    std::size_t from{0};
    std::size_t to{0};
    double growth{0};
};
[[nodiscard]] std::vector<Step> find_steps(const std::vector<Series>& all);

/// Prints the series and their steps as tables for people, or as one JSON object.
void print(const std::vector<Series>& all, bool json);

} // namespace busbar::bench

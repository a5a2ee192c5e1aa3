#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace busbar::bench {

/// What a machine does from the text of its declarations to the state Running (W588, 4-2-4).
inline constexpr std::array<std::string_view, 6> startup_phases{
    "declarations", // are read
    "publication",  // types are checked and variables chosen
    "server",       // is made, with namespace 0
    "image",        // of the published variables
    "nodes",        // of the controller
    "records",      // of the variables, for the logs
};

/// A machine with so many variables.
struct StartupPoint {
    std::size_t count{0};
    std::size_t published{0};
    /// With the limits of the preset, else without any.
    bool is_limited{true};
    /// Milliseconds of processor time of each phase.
    std::array<double, startup_phases.size()> phase_ms{};
    /// Until Running: all of them, and what lies between.
    double running_ms{0};
    /// Afterwards, on another thread: until the execution log is saved.
    double saving_ms{0};
};

/// How many times as much `figure` costs for each variable as at the point before; 1 is linear.
/// None for the first point, and none where it cost nothing.
[[nodiscard]] std::optional<double> growth(const std::vector<StartupPoint>& points,
                                           std::size_t point, double StartupPoint::*figure);
[[nodiscard]] std::optional<double> phase_growth(const std::vector<StartupPoint>& points,
                                                 std::size_t point, std::size_t phase);

/// Prints a table for people, or one JSON object.
void print(const std::vector<StartupPoint>& points, bool json);

} // namespace busbar::bench

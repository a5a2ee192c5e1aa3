#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <busbar/core/problem.hpp>

#include "mapped/mapped_model.hpp"

namespace busbar::bench {

/// What is done with a project of model mode (SH-082679, 9.4, 4.2 and 9.13).
inline constexpr std::array<std::string_view, 5> project_phases{
    "import", // its models, by which their mapping is read
    "check",  // of the mapping, with the counters of the status bar
    "export", // the models with their mapping
    "write",  // to a server's store: the file is made, staged, read, checked and switched to
    "verify", // read from the store and compared, node by node
};

/// What one size of a project costs.
struct ProjectPoint {
    std::size_t nodes{0};
    std::size_t mapped{0};
    std::size_t files{0};
    /// With the ceilings of RD81OPC96, else without any.
    bool is_limited{true};
    std::size_t file_bytes{0};
    /// Microseconds of processor time of each phase.
    std::array<double, project_phases.size()> phase_us{};
    /// On the heap, of the imported models; and the most that the process had while it wrote.
    std::size_t held_bytes{0};
    std::size_t most_bytes{0};

    [[nodiscard]] double per_node(double figure) const
    {
        return nodes == 0 ? 0 : figure / static_cast<double>(nodes);
    }
};

/// How many times as much a figure is for each node as at the point before; 1 is linear. None
/// where there is no point before, or it cost nothing.
[[nodiscard]] std::optional<double> project_growth(const std::vector<ProjectPoint>& points,
                                                   std::size_t point, std::size_t phase);

struct ProjectOptions {
    /// 50,000 nodes in one file, of which 25,000 are mapped: all that the preset takes.
    MappedModel limited{.fillers = 99};
    /// Ten such files, without the preset.
    MappedModel open{.objects = 2'500, .fillers = 99, .files = 10};
};

/// Makes both projects in turn. A problem says which phase failed.
[[nodiscard]] Configured<std::vector<ProjectPoint>> measure_projects(const ProjectOptions& options);

/// Prints a table for people, or one JSON object.
void print(const std::vector<ProjectPoint>& points, bool json);

} // namespace busbar::bench

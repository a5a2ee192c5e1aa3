#include <cstdio>
#include <string>

#include "project.hpp"

namespace busbar::bench {

namespace {

void print_table(const std::vector<ProjectPoint>& points)
{
    std::printf("%-28s", "project of nodes (mapped)");
    for (const ProjectPoint& point : points) {
        std::printf(" %10zu (%zu)", point.nodes, point.mapped);
    }
    std::printf("\n%-28s", "files, preset");
    for (const ProjectPoint& point : points) {
        std::printf(" %8zu %9s", point.files, point.is_limited ? "rd81opc96" : "none");
    }
    for (std::size_t phase = 0; phase < project_phases.size(); ++phase) {
        std::printf("\n%-28s", (std::string{project_phases.at(phase)} + ", us a node").c_str());
        for (std::size_t i = 0; i < points.size(); ++i) {
            std::printf(" %10.2f", points[i].per_node(points[i].phase_us.at(phase)));
            if (const auto grown = project_growth(points, i, phase)) {
                std::printf(" (%4.2f)", *grown);
            } else {
                std::printf("       ");
            }
        }
    }
    std::printf("\n%-28s", "held, bytes a node");
    for (const ProjectPoint& point : points) {
        std::printf(" %10.0f       ", point.per_node(static_cast<double>(point.held_bytes)));
    }
    std::printf("\n%-28s", "most in write, bytes a node");
    for (const ProjectPoint& point : points) {
        std::printf(" %10.0f       ", point.per_node(static_cast<double>(point.most_bytes)));
    }
    std::printf("\nprocessor time; in brackets the growth for each node, 1 is linear\n");
}

void print_row(const std::vector<ProjectPoint>& points, std::size_t row)
{
    const ProjectPoint& point = points[row];
    std::printf("{\"nodes\": %zu, \"mapped\": %zu, \"files\": %zu, \"preset\": %s, "
                "\"file_bytes\": %zu",
                point.nodes, point.mapped, point.files, point.is_limited ? "\"rd81opc96\"" : "null",
                point.file_bytes);
    for (std::size_t phase = 0; phase < project_phases.size(); ++phase) {
        const std::string name{project_phases.at(phase)};
        std::printf(", \"%s_us_per_node\": %.3f, \"%s_growth\": ", name.c_str(),
                    point.per_node(point.phase_us.at(phase)), name.c_str());
        if (const auto grown = project_growth(points, row, phase)) {
            std::printf("%.3f", *grown);
        } else {
            std::printf("null");
        }
    }
    std::printf(", \"held_bytes\": %zu, \"most_bytes\": %zu}", point.held_bytes, point.most_bytes);
}

} // namespace

std::optional<double> project_growth(const std::vector<ProjectPoint>& points, std::size_t point,
                                     std::size_t phase)
{
    if (point == 0) {
        return std::nullopt;
    }
    const double before = points[point - 1].per_node(points[point - 1].phase_us.at(phase));
    return before > 0
               ? std::optional{points[point].per_node(points[point].phase_us.at(phase)) / before}
               : std::nullopt;
}

void print(const std::vector<ProjectPoint>& points, bool json)
{
    if (!json) {
        print_table(points);
        return;
    }
    std::printf("{\"rows\": [");
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::printf("%s\n  ", i == 0 ? "" : ",");
        print_row(points, i);
    }
    std::printf("\n]}\n");
}

} // namespace busbar::bench

#include "startup.hpp"

#include <cstdio>
#include <string>

namespace busbar::bench {

namespace {

std::optional<double> growth_of(double before, std::size_t count_before, double now,
                                std::size_t count)
{
    if (before <= 0 || count_before == 0 || count == 0) {
        return std::nullopt;
    }
    return now / static_cast<double>(count) * static_cast<double>(count_before) / before;
}

void print_figure(double ms, const std::optional<double>& grown)
{
    if (grown) {
        std::printf(" %10.2f (%4.2f)", ms, *grown);
    } else {
        std::printf(" %10.2f       ", ms);
    }
}

void print_table(const std::vector<StartupPoint>& points)
{
    std::printf("%-8s %6s", "of INT", "limits");
    for (const std::string_view phase : startup_phases) {
        std::printf(" %17s", std::string{phase}.c_str());
    }
    std::printf(" %17s %17s\n", "Running", "log is saved");
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::printf("%-8zu %6s", points[i].count, points[i].is_limited ? "nj501" : "none");
        for (std::size_t phase = 0; phase < startup_phases.size(); ++phase) {
            print_figure(points[i].phase_ms.at(phase), phase_growth(points, i, phase));
        }
        print_figure(points[i].running_ms, growth(points, i, &StartupPoint::running_ms));
        print_figure(points[i].saving_ms, growth(points, i, &StartupPoint::saving_ms));
        std::printf("\n");
    }
    std::printf("ms of processor time; in brackets the growth for each variable, 1 is linear\n");
}

void print_growth(const std::optional<double>& grown)
{
    if (grown) {
        std::printf("%.3f", *grown);
    } else {
        std::printf("null");
    }
}

void print_row(const std::vector<StartupPoint>& points, std::size_t row)
{
    const StartupPoint& point = points[row];
    std::printf("{\"count\": %zu, \"published\": %zu, \"limits\": %s, ", point.count,
                point.published, point.is_limited ? "\"nj501\"" : "null");
    for (std::size_t phase = 0; phase < startup_phases.size(); ++phase) {
        std::printf("\"%s_ms\": %.3f, ", std::string{startup_phases.at(phase)}.c_str(),
                    point.phase_ms.at(phase));
    }
    std::printf("\"running_ms\": %.3f, \"saving_ms\": %.3f, \"growth\": ", point.running_ms,
                point.saving_ms);
    print_growth(growth(points, row, &StartupPoint::running_ms));
    std::printf("}");
}

} // namespace

std::optional<double> growth(const std::vector<StartupPoint>& points, std::size_t point,
                             double StartupPoint::*figure)
{
    return point == 0 ? std::nullopt
                      : growth_of(points[point - 1].*figure, points[point - 1].count,
                                  points[point].*figure, points[point].count);
}

std::optional<double> phase_growth(const std::vector<StartupPoint>& points, std::size_t point,
                                   std::size_t phase)
{
    return point == 0 ? std::nullopt
                      : growth_of(points[point - 1].phase_ms.at(phase), points[point - 1].count,
                                  points[point].phase_ms.at(phase), points[point].count);
}

void print(const std::vector<StartupPoint>& points, bool json)
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

#include "series.hpp"

#include <cstdio>

#include "json_text.hpp"

namespace busbar::bench {

namespace {

struct Cost {
    const char* name;
    double Point::*figure;
};
constexpr Cost costs[] = {
    {"create", &Point::create_us}, {"read", &Point::read_us}, {"delete", &Point::delete_us}};

/// Over the point before; none of the first, and none where that cost nothing.
std::optional<double> growth(const Series& series, std::size_t point, double Point::*figure)
{
    if (point == 0 || series.points[point - 1].*figure <= 0) {
        return std::nullopt;
    }
    return series.points[point].*figure / (series.points[point - 1].*figure);
}

void print_table(const Series& series)
{
    std::printf("%-12s", series.of.c_str());
    for (const Cost& cost : costs) {
        std::printf(" %9s us %8s", cost.name, "growth");
    }
    std::printf("\n");
    for (std::size_t i = 0; i < series.points.size(); ++i) {
        std::printf("%-12zu", series.points[i].count);
        for (const Cost& cost : costs) {
            if (const double figure = series.points[i].*cost.figure; figure > 0) {
                std::printf(" %12.2f", figure);
            } else {
                std::printf(" %12s", "-");
            }
            if (const auto grown = growth(series, i, cost.figure)) {
                std::printf(" %8.2f", *grown);
            } else {
                std::printf(" %8s", "-");
            }
        }
        std::printf("\n");
    }
    std::printf("\n");
}

void print_json(const std::vector<Series>& all)
{
    std::printf("{\"rows\": [");
    const char* separator = "";
    for (const Series& series : all) {
        for (const Point& point : series.points) {
            std::printf("%s\n  {\"of\": %s, \"count\": %zu, \"create_us\": %.3f, \"read_us\": %.3f",
                        separator, json_text(series.of).c_str(), point.count, point.create_us,
                        point.read_us);
            if (point.delete_us > 0) {
                std::printf(", \"delete_us\": %.3f", point.delete_us);
            }
            std::printf("}");
            separator = ",";
        }
    }
    std::printf("\n], \"steps\": [");
    separator = "";
    for (const Step& step : find_steps(all)) {
        std::printf("%s\n  {\"of\": %s, \"cost\": %s, \"from\": %zu, \"to\": %zu, "
                    "\"growth\": %.2f}",
                    separator, json_text(step.of).c_str(), json_text(step.cost).c_str(), step.from,
                    step.to, step.growth);
        separator = ",";
    }
    std::printf("\n]}\n");
}

} // namespace

std::vector<Step> find_steps(const std::vector<Series>& all)
{
    std::vector<Step> steps;
    for (const Series& series : all) {
        for (std::size_t i = 1; i < series.points.size(); ++i) {
            for (const Cost& cost : costs) {
                const auto grown = growth(series, i, cost.figure);
                if (grown && *grown > step_growth) {
                    steps.push_back({series.of, cost.name, series.points[i - 1].count,
                                     series.points[i].count, *grown});
                }
            }
        }
    }
    return steps;
}

void print(const std::vector<Series>& all, bool json)
{
    if (json) {
        print_json(all);
        return;
    }
    for (const Series& series : all) {
        print_table(series);
    }
    const auto steps = find_steps(all);
    if (steps.empty()) {
        std::printf("no step: nothing costs more than %.1f times what it cost before\n",
                    step_growth);
    }
    for (const Step& step : steps) {
        std::printf("step: %s, %s %zu to %zu: %.2f times\n", step.of.c_str(), step.cost.c_str(),
                    step.from, step.to, step.growth);
    }
}

} // namespace busbar::bench

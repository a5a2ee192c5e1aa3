#include "report.hpp"

#include <cstdio>

namespace busbar::bench {

namespace {

void print_table(const Options& options, const std::vector<Row>& rows)
{
    std::printf("%s  %s %s\n", options.url.c_str(), options.policy.c_str(), options.mode.c_str());
    std::printf("%-26s %8s %12s %12s %12s %12s %8s %12s\n", "load", "runs", "median us", "best us",
                "p99 us", "floor us", "x floor", "per second");
    for (const Row& row : rows) {
        std::printf("%-26s %8zu %12.1f %12.1f %12.1f ", row.load.c_str(), row.runs, row.median_us,
                    row.best_us, row.p99_us);
        if (row.floor_us > 0) {
            std::printf("%12.1f %8.2f ", row.floor_us, row.median_us / row.floor_us);
        } else {
            std::printf("%12s %8s ", "-", "-");
        }
        std::printf("%12.0f\n", row.per_second);
    }
}

void print_json(const Options& options, const std::vector<Row>& rows)
{
    std::printf("{\"url\": \"%s\", \"policy\": \"%s\", \"mode\": \"%s\", \"rows\": [",
                options.url.c_str(), options.policy.c_str(), options.mode.c_str());
    const char* separator = "";
    for (const Row& row : rows) {
        std::printf("%s\n  {\"load\": \"%s\", \"runs\": %zu, \"median_us\": %.2f, \"best_us\": "
                    "%.2f, \"p99_us\": %.2f, \"floor_us\": %.2f, \"per_second\": %.1f}",
                    separator, row.load.c_str(), row.runs, row.median_us, row.best_us, row.p99_us,
                    row.floor_us, row.per_second);
        separator = ",";
    }
    std::printf("\n]}\n");
}

} // namespace

void print(const Options& options, const std::vector<Row>& rows)
{
    if (options.json) {
        print_json(options, rows);
    } else {
        print_table(options, rows);
    }
}

} // namespace busbar::bench

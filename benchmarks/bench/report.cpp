#include "report.hpp"

#include <algorithm>
#include <cstdio>

#include "json_text.hpp"

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
    std::printf("{\"url\": %s, \"policy\": %s, \"mode\": %s, \"rows\": [",
                quoted(options.url).c_str(), quoted(options.policy).c_str(),
                quoted(options.mode).c_str());
    const char* separator = "";
    for (const Row& row : rows) {
        std::printf("%s\n  {\"load\": %s, \"runs\": %zu, \"median_us\": %.2f, \"best_us\": "
                    "%.2f, \"p99_us\": %.2f, \"floor_us\": %.2f, \"per_second\": %.1f}",
                    separator, quoted(row.load).c_str(), row.runs, row.median_us, row.best_us,
                    row.p99_us, row.floor_us, row.per_second);
        separator = ",";
    }
    std::printf("\n]}\n");
}

void print_table(const std::vector<HostileRow>& rows, bool has_memory)
{
    std::printf("%-28s %9s %9s %8s %7s %11s %11s %11s %11s", "attack", "answered", "refused",
                "reads", "failed", "median us", "p90 us", "p99 us", "worst us");
    const bool has_gaps = std::any_of(rows.begin(), rows.end(),
                                      [](const HostileRow& row) { return row.publishes != 0; });
    if (has_gaps) {
        std::printf(" %10s %10s", "publishes", "gap ms");
    }
    const bool has_logins = std::any_of(rows.begin(), rows.end(),
                                        [](const HostileRow& row) { return row.logins != 0; });
    if (has_logins) {
        std::printf(" %8s %7s %10s", "logins", "failed", "worst ms");
    }
    std::printf(has_memory ? " %10s %10s\n" : "\n", "peak MB", "left MB");
    for (const HostileRow& row : rows) {
        std::printf("%-28s %9zu %9zu %8zu %7zu %11.1f %11.1f %11.1f %11.1f", row.attack.c_str(),
                    row.answered, row.refused, row.reads, row.failed, row.median_us, row.p90_us,
                    row.p99_us, row.worst_us);
        if (has_gaps) {
            std::printf(" %10zu %10.1f", row.publishes, row.longest_gap_ms);
        }
        if (has_logins) {
            std::printf(" %8zu %7zu %10.1f", row.logins, row.failed_logins, row.worst_login_ms);
        }
        if (has_memory) {
            std::printf(" %+10.1f %+10.1f", row.peak_growth_mb(), row.growth_mb());
        }
        std::printf("\n");
    }
}

void print_json(const std::vector<HostileRow>& rows, bool has_memory)
{
    const char* separator = "";
    for (const HostileRow& row : rows) {
        std::printf("%s\n  {\"attack\": %s, \"answered\": %zu, \"refused\": %zu, \"reads\": %zu, "
                    "\"failed\": %zu, \"median_us\": %.2f, \"p90_us\": %.2f, \"p99_us\": %.2f, "
                    "\"worst_us\": %.2f, \"publishes\": %zu, \"longest_gap_ms\": %.2f, "
                    "\"logins\": %zu, \"failed_logins\": %zu, \"worst_login_ms\": %.2f",
                    separator, quoted(row.attack).c_str(), row.answered, row.refused, row.reads,
                    row.failed, row.median_us, row.p90_us, row.p99_us, row.worst_us, row.publishes,
                    row.longest_gap_ms, row.logins, row.failed_logins, row.worst_login_ms);
        if (has_memory) {
            std::printf(", \"peak_growth_mb\": %.2f, \"growth_mb\": %.2f", row.peak_growth_mb(),
                        row.growth_mb());
        }
        std::printf("}");
        separator = ",";
    }
    std::printf("\n]}\n");
}

} // namespace

void print(const Options& options, const HostileOptions& hostile,
           const std::vector<HostileRow>& rows)
{
    const bool has_memory = hostile.server_process != 0;
    if (options.json) {
        std::printf("{\"url\": %s, \"policy\": %s, \"mode\": %s, \"rows\": [",
                    quoted(options.url).c_str(), quoted(options.policy).c_str(),
                    quoted(options.mode).c_str());
        print_json(rows, has_memory);
    } else {
        std::printf("%s  %s %s\n", options.url.c_str(), options.policy.c_str(),
                    options.mode.c_str());
        print_table(rows, has_memory);
    }
}

void print(const Options& options, const std::vector<Row>& rows)
{
    if (options.json) {
        print_json(options, rows);
    } else {
        print_table(options, rows);
    }
}

} // namespace busbar::bench

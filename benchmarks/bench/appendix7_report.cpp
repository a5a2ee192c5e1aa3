#include <cstdio>

#include "appendix7.hpp"

namespace busbar::bench {

namespace {

void print_table(const std::vector<SevenRow>& rows)
{
    std::printf("%-13s %-9s %10s %8s %6s %7s %11s %11s %11s %9s %9s\n", "load", "mode", "Variables",
                "Objects", "files", "mapped", "manual ms", "measured ms", "floor ms", "manual/",
                "/floor");
    for (const SevenRow& row : rows) {
        std::printf("%-13s %-9s %10zu %8zu %6zu %7s", row.load.c_str(),
                    std::string{mode_name(row.mode)}.c_str(), row.variables, row.objects, row.files,
                    row.is_mapped ? "yes" : "no");
        if (row.manual_ms) {
            std::printf(" %11.1f %11.2f %11.2f %9.1f", *row.manual_ms, row.measured_ms,
                        row.floor_ms, *row.manual_ms / row.measured_ms);
        } else {
            std::printf(" %11s %11.2f %11.2f %9s", "-", row.measured_ms, row.floor_ms, "-");
        }
        std::printf(" %9.2f\n", row.measured_ms / row.floor_ms);
    }
    std::printf("means; wall time as the client sees it, of startup processor time\n");
}

void print_row(const SevenRow& row)
{
    std::printf("{\"load\": \"%s\", \"mode\": \"%s\", \"variables\": %zu, \"objects\": %zu, "
                "\"files\": %zu, \"mapped\": %s, \"rounds\": %d, ",
                row.load.c_str(), std::string{mode_name(row.mode)}.c_str(), row.variables,
                row.objects, row.files, row.is_mapped ? "true" : "false", row.rounds);
    if (row.manual_ms) {
        std::printf("\"manual_ms\": %.1f", *row.manual_ms);
    } else {
        std::printf("\"manual_ms\": null");
    }
    std::printf(", \"measured_ms\": %.3f, \"floor_ms\": %.3f, \"time\": \"%s\"}", row.measured_ms,
                row.floor_ms, row.load == "startup" ? "processor" : "wall");
}

} // namespace

void print(const std::vector<SevenRow>& rows, bool json)
{
    if (!json) {
        print_table(rows);
        return;
    }
    std::printf("{\"rows\": [");
    const char* separator = "";
    for (const SevenRow& row : rows) {
        std::printf("%s\n  ", separator);
        print_row(row);
        separator = ",";
    }
    std::printf("\n]}\n");
}

} // namespace busbar::bench

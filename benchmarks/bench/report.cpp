#include "report.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>

#include "json_text.hpp"

namespace busbar::bench {

namespace {

/// As wide as its column; a dash for what is not known or not above 0.
void print_figure(int width, int digits, double figure)
{
    if (figure > 0) {
        std::printf(" %*.*f", width, digits, figure);
    } else {
        std::printf(" %*s", width, "-");
    }
}

void print_ratio(double figure, double floor)
{
    print_figure(7, 2, floor > 0 ? figure / floor : 0);
}

void print_head(const Options& options)
{
    std::printf("%s  %s %s", options.url.c_str(), options.policy.c_str(), options.mode.c_str());
}

void print_table(const Options& options, const std::vector<Row>& rows)
{
    print_head(options);
    std::printf("  %s order\n", options.is_sequential ? "sequential" : "random");
    std::printf("%-26s %8s %10s %10s %10s %10s %7s %10s %10s %10s %7s %7s %7s\n", "load", "runs",
                "median us", "best us", "p99 us", "floor us", "x floor", "per second", "server us",
                "floor us", "x floor", "faults", "calls");
    for (const Row& row : rows) {
        std::printf("%-26s %8zu", row.load.c_str(), row.runs);
        for (const double figure : {row.median_us, row.best_us, row.p99_us, row.floor.both_us}) {
            print_figure(10, 1, figure);
        }
        print_ratio(row.median_us, row.floor.both_us);
        print_figure(10, 0, row.per_second);
        const double server_us = row.server ? row.server->processor_us : 0;
        print_figure(10, 2, server_us);
        print_figure(10, 2, row.floor.server_us);
        print_ratio(server_us, row.floor.server_us);
        if (row.server) {
            std::printf(" %7.2f", row.server->page_faults);
        } else {
            print_figure(7, 2, 0);
        }
        print_figure(7, 2, row.server ? row.server->system_calls.value_or(0) : 0);
        std::printf("\n");
    }
}

/// A member of an object of JSON, if it is known.
void print_member(const char* name, const std::optional<double>& figure)
{
    if (figure) {
        std::printf(", \"%s\": %.3f", name, *figure);
    }
}

void print_json_head(const Options& options)
{
    std::printf("{\"url\": %s, \"policy\": %s, \"mode\": %s, \"rows\": [",
                json_text(options.url).c_str(), json_text(options.policy).c_str(),
                json_text(options.mode).c_str());
}

void print_json(const Options& options, const std::vector<Row>& rows)
{
    print_json_head(options);
    const char* separator = "";
    const auto positive = [](double figure) {
        return figure > 0 ? std::optional{figure} : std::nullopt;
    };
    for (const Row& row : rows) {
        std::printf("%s\n  {\"load\": %s, \"round\": %zu, \"runs\": %zu", separator,
                    json_text(row.load).c_str(), row.round, row.runs);
        print_member("median_us", row.median_us);
        print_member("best_us", positive(row.best_us));
        print_member("p99_us", positive(row.p99_us));
        print_member("floor_us", positive(row.floor.both_us));
        print_member("server_floor_us", positive(row.floor.server_us));
        print_member("per_second", row.per_second);
        if (row.server) {
            print_member("server_us", row.server->processor_us);
            print_member("page_faults", row.server->page_faults);
            print_member("system_calls", row.server->system_calls);
        }
        std::printf("}");
        separator = ",";
    }
    std::printf("\n]}\n");
}

void print_table(const std::vector<SubscribeRow>& rows)
{
    std::printf("%8s %9s %9s %9s %14s %7s %9s %6s %6s %11s\n", "items", "publishes", "mean ms",
                "worst ms", "notifications/s", "cpu %", "RSS MB", "lost", "wrong", "step scans");
    for (const SubscribeRow& row : rows) {
        std::printf("%8zu %9zu %9.1f %9.1f %14.0f %7.1f %9.1f %6zu %6zu %5u-%u\n", row.items,
                    row.publishes, row.mean_interval_ms, row.worst_interval_ms,
                    row.notifications_per_second, row.cpu_percent, row.resident_mb,
                    row.messages_lost, row.values_wrong, unsigned{row.smallest_step},
                    unsigned{row.largest_step});
    }
}

void print_json(const Options& options, const std::vector<SubscribeRow>& rows)
{
    print_json_head(options);
    const char* separator = "";
    for (const SubscribeRow& row : rows) {
        std::printf("%s\n  {\"load\": \"%zu items\", \"round\": %zu, \"publishes\": %zu, "
                    "\"messages_lost\": %zu, \"values_wrong\": %zu",
                    separator, row.items, row.round, row.publishes, row.messages_lost,
                    row.values_wrong);
        print_member("mean_interval_ms", row.mean_interval_ms);
        print_member("worst_interval_ms", row.worst_interval_ms);
        print_member("notifications_per_second", row.notifications_per_second);
        if (options.subscribe.server_pid != 0) {
            print_member("cpu_percent", row.cpu_percent);
            print_member("resident_mb", row.resident_mb);
        }
        std::printf("}");
        separator = ",";
    }
    std::printf("\n]}\n");
}

void print_table(const std::vector<HostileRow>& rows, bool has_memory)
{
    std::size_t longest = 28;
    for (const HostileRow& row : rows) {
        longest = std::max(longest, row.attack.size());
    }
    const int width = static_cast<int>(longest);
    std::printf("%-*s %9s %9s %8s %7s %11s %11s %11s %11s", width, "attack", "answered", "refused",
                "reads", "failed", "median us", "p90 us", "p99 us", "worst us");
    const bool has_gaps = std::any_of(rows.begin(), rows.end(),
                                      [](const HostileRow& row) { return row.publishes != 0; });
    if (has_gaps) {
        std::printf(" %10s %10s", "publishes", "gap ms");
    }
    const bool has_logins = std::any_of(rows.begin(), rows.end(),
                                        [](const HostileRow& row) { return row.logins != 0; });
    if (has_logins) {
        std::printf(" %8s %7s %10s %7s", "logins", "failed", "worst ms", "before");
    }
    if (has_memory) {
        std::printf(" %10s %10s", "peak MB", "left MB");
    }
    const bool has_calls = std::any_of(rows.begin(), rows.end(), [](const HostileRow& row) {
        return !row.status.empty() || row.longest_piece_ms > 0;
    });
    std::printf(has_calls ? " %10s status\n" : "\n", "piece ms");
    for (const HostileRow& row : rows) {
        std::printf("%-*s %9zu %9zu %8zu %7zu %11.1f %11.1f %11.1f %11.1f", width,
                    row.attack.c_str(), row.answered, row.refused, row.reads, row.failed,
                    row.median_us, row.p90_us, row.p99_us, row.worst_us);
        if (has_gaps) {
            std::printf(" %10zu %10.1f", row.publishes, row.longest_gap_ms);
        }
        if (has_logins) {
            std::printf(" %8zu %7zu %10.1f %7zu", row.logins, row.failed_logins, row.worst_login_ms,
                        row.most_before_login);
        }
        if (has_memory) {
            std::printf(" %+10.1f %+10.1f", row.peak_growth_mb(), row.growth_mb());
        }
        if (has_calls) {
            print_figure(10, 1, row.longest_piece_ms);
            std::printf(" %s", row.status.c_str());
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
                    "\"logins\": %zu, \"failed_logins\": %zu, \"worst_login_ms\": %.2f, "
                    "\"most_before_login\": %zu",
                    separator, json_text(row.attack).c_str(), row.answered, row.refused, row.reads,
                    row.failed, row.median_us, row.p90_us, row.p99_us, row.worst_us, row.publishes,
                    row.longest_gap_ms, row.logins, row.failed_logins, row.worst_login_ms,
                    row.most_before_login);
        if (has_memory) {
            std::printf(", \"peak_growth_mb\": %.2f, \"growth_mb\": %.2f", row.peak_growth_mb(),
                        row.growth_mb());
        }
        if (!row.status.empty()) {
            std::printf(", \"longest_piece_ms\": %.2f, \"status\": %s", row.longest_piece_ms,
                        json_text(row.status).c_str());
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
        print_json_head(options);
        print_json(rows, has_memory);
    } else {
        print_head(options);
        std::printf("\n");
        print_table(rows, has_memory);
    }
}

void print(const ChurnReport& report)
{
    std::printf("%-30s %9s %9s\n", "what", "good", "refused");
    for (const ChurnRow& row : report.rows) {
        std::printf("%-30s %9zu %9zu\n", row.what.c_str(), row.good, row.refused);
    }
    std::printf("seed %u, memory %.1f MB, at the end %.1f MB\n", report.seed, report.before.now_mb,
                report.after.now_mb);
    if (!report.is_well()) {
        std::printf("%s, exit code %d%s%s\n", report.serves ? "served" : "did not serve any more",
                    report.exit_code, report.complaint.empty() ? "" : ", ",
                    report.complaint.c_str());
        if (const std::string what = report.never_done(); !what.empty()) {
            std::printf("never went well: %s\n", what.c_str());
        }
        std::printf("see %s\n", report.folder.c_str());
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

void print(const Options& options, const std::vector<SubscribeRow>& rows)
{
    if (options.json) {
        print_json(options, rows);
    } else {
        print_head(options);
        std::printf(", %.0f ms\n", options.subscribe.publishing_ms);
        print_table(rows);
    }
}

} // namespace busbar::bench

#include "compare.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "core/json.hpp"
#include "core/number_text.hpp"

namespace busbar::bench {

namespace {

using detail::Json;

/// Of all that a row may have, what is less where the server is better.
constexpr const char* cost_keys[] = {"median_us",   "best_us",      "p99_us",     "server_us",
                                     "page_faults", "system_calls", "cpu_percent"};

/// The figures of one run: by load and cost, then by round.
using Rounds = std::map<std::size_t, double>;
struct Run {
    std::vector<std::string> loads; // in the order of the file
    std::map<std::pair<std::string, std::string>, Rounds> figures;
};

/// None if it is no number, or none that T has.
template <typename T>
std::optional<T> number(const Json* value)
{
    T number{};
    if (value == nullptr || value->kind != Json::Kind::Number) {
        return std::nullopt;
    }
    const char* const end = value->text.data() + value->text.size();
    const auto read = detail::read_number(value->text.data(), end, number);
    return read.ec == std::errc{} && read.ptr == end ? std::optional{number} : std::nullopt;
}

/// False if the row has no load.
bool take_row(Run& run, const Json& row)
{
    const Json* const load = row.find("load");
    if (load == nullptr || load->kind != Json::Kind::String) {
        return false;
    }
    if (std::find(run.loads.begin(), run.loads.end(), load->text) == run.loads.end()) {
        run.loads.push_back(load->text);
    }
    const auto round = number<std::size_t>(row.find("round")).value_or(0);
    for (const char* cost : cost_keys) {
        if (const auto figure = number<double>(row.find(cost))) {
            run.figures[{load->text, cost}][round] = *figure;
        }
    }
    return true;
}

Expected<Run, std::string> read_run(const std::string& path)
{
    std::ifstream file{path, std::ios::binary};
    if (!file) {
        return Unexpected{path + ": the file cannot be read"};
    }
    const std::string text{std::istreambuf_iterator<char>{file}, {}};
    const auto json = detail::parse_json(text);
    if (!json) {
        return Unexpected{path + ": " + json.error()};
    }
    const Json* const rows = json->kind == Json::Kind::Object ? json->find("rows") : nullptr;
    if (rows == nullptr || rows->kind != Json::Kind::List) {
        return Unexpected{path + ": found no \"rows\", expected what --json prints"};
    }
    Run run;
    for (std::size_t i = 0; i < rows->items.size(); ++i) {
        const Json& row = rows->items[i];
        if (row.kind != Json::Kind::Object || !take_row(run, row)) {
            return Unexpected{path + ": row " + std::to_string(i + 1) +
                              ": found no \"load\", expected what --json prints of loads"};
        }
    }
    return run;
}

/// Of at least one.
double median(std::vector<double> values)
{
    const std::size_t middle = values.size() / 2;
    std::sort(values.begin(), values.end());
    return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

double median(const Rounds& rounds)
{
    std::vector<double> values;
    for (const auto& [round, value] : rounds) {
        values.push_back(value);
    }
    return median(std::move(values));
}

Compared compare(const Rounds& before, const Rounds& after)
{
    Compared line;
    line.before = median(before);
    line.after = median(after);
    for (const auto& [round, value] : before) {
        const auto same = after.find(round);
        if (same != after.end() && value > 0) {
            line.ratios.push_back(same->second / value);
        }
    }
    line.ratio = line.ratios.empty() ? 0 : median(line.ratios);
    return line;
}

} // namespace

Expected<std::vector<Compared>, std::string> compare(const std::string& before,
                                                     const std::string& after)
{
    const auto first = read_run(before);
    const auto second = read_run(after);
    if (!first || !second) {
        return Unexpected{first ? second.error() : first.error()};
    }
    std::vector<Compared> lines;
    for (const std::string& load : first->loads) {
        for (const char* cost : cost_keys) {
            const auto old = first->figures.find({load, cost});
            const auto now = second->figures.find({load, cost});
            if (old == first->figures.end() || now == second->figures.end()) {
                continue;
            }
            Compared line = compare(old->second, now->second);
            line.load = load;
            line.figure = cost;
            lines.push_back(std::move(line));
        }
    }
    if (lines.empty()) {
        return Unexpected{before + " and " + after + ": found no load that both have"};
    }
    return lines;
}

void print(const std::vector<Compared>& lines)
{
    std::printf("%-26s %-14s %12s %12s %8s   %s\n", "load", "figure", "before", "after", "ratio",
                "round by round");
    for (const Compared& line : lines) {
        std::printf("%-26s %-14s %12.2f %12.2f ", line.load.c_str(), line.figure.c_str(),
                    line.before, line.after);
        if (line.ratios.empty()) {
            std::printf("%8s", "-");
        } else {
            std::printf("%8.2f  ", line.ratio);
        }
        for (const double ratio : line.ratios) {
            std::printf(" %.2f", ratio);
        }
        std::printf("\n");
    }
}

} // namespace busbar::bench

#include "figures.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>

#include <malloc.h>

namespace busbar::bench {

void GrowthTable::add(const std::string& figure, double value)
{
    const auto found = std::find_if(rows_.begin(), rows_.end(),
                                    [&](const Row& row) { return row.figure == figure; });
    if (found != rows_.end()) {
        found->values.push_back(value);
    } else {
        rows_.push_back({figure, {value}});
    }
}

void GrowthTable::print(const char* title) const
{
    std::printf("\n%-34s", title);
    for (std::size_t i = 0; i < sizes_.size(); ++i) {
        std::printf(i == 0 ? " %10u" : " %10u  growth", sizes_[i]);
    }
    std::printf("\n");
    for (const Row& row : rows_) {
        std::printf("%-34s", row.figure.c_str());
        for (std::size_t i = 0; i < row.values.size(); ++i) {
            std::printf(" %10.1f", row.values[i]);
            if (i != 0) {
                std::printf("  %6.2f", row.values[i] / row.values[i - 1]);
            }
        }
        std::printf("\n");
    }
}

double peak_megabytes()
{
    std::ifstream status{"/proc/self/status"};
    for (std::string word; status >> word;) {
        if (word == "VmHWM:") {
            double kilobytes = 0;
            status >> kilobytes;
            return kilobytes / 1'024;
        }
    }
    return 0;
}

void forget_peak()
{
    ::malloc_trim(0);
    std::ofstream{"/proc/self/clear_refs"} << "5";
}

} // namespace busbar::bench

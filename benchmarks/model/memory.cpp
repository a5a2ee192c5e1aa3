#include "memory.hpp"

#include <fstream>
#include <string>

#include <malloc.h>

namespace busbar::bench {

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

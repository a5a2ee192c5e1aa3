#include "process.hpp"

#include <cstdio>
#include <fstream>
#include <string>
#include <unistd.h>

namespace busbar::bench {

namespace {

std::string file_of(pid_t process, const char* name)
{
    return "/proc/" + std::to_string(process) + "/" + name;
}

} // namespace

double processor_time(pid_t process)
{
    std::ifstream file{file_of(process, "stat")};
    std::string text;
    std::getline(file, text);
    double user = 0;
    double system = 0;
    const std::size_t name_end = text.rfind(')');
    if (name_end == std::string::npos ||
        std::sscanf(text.c_str() + name_end,
                    ") %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lf %lf", &user, &system) != 2) {
        return 0;
    }
    return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

Memory memory_of(pid_t process)
{
    constexpr double kib_per_mb = 1e6 / 1024;
    Memory memory;
    std::ifstream file{file_of(process, "status")};
    double kib = 0;
    for (std::string line; std::getline(file, line);) {
        if (std::sscanf(line.c_str(), "VmRSS: %lf kB", &kib) == 1) {
            memory.now_mb = kib / kib_per_mb;
        } else if (std::sscanf(line.c_str(), "VmHWM: %lf kB", &kib) == 1) {
            memory.peak_mb = kib / kib_per_mb;
        }
    }
    return memory;
}

void forget_peak(pid_t process)
{
    std::ofstream{file_of(process, "clear_refs")} << "5";
}

} // namespace busbar::bench

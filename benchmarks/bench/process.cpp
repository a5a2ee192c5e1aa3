#include "process.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <unistd.h>

namespace busbar::bench {

namespace {

std::string file_of(pid_t process, const char* name)
{
    return "/proc/" + std::to_string(process) + "/" + name;
}

struct Stat {
    double minor_faults{0};
    double major_faults{0};
    /// In ticks.
    double user{0};
    double system{0};
};

/// Zeros if there is no process of that id.
Stat stat_of(pid_t process)
{
    std::ifstream file{file_of(process, "stat")};
    std::string text;
    std::getline(file, text);
    Stat fields;
    const std::size_t name_end = text.rfind(')');
    if (name_end == std::string::npos ||
        std::sscanf(text.c_str() + name_end,
                    ") %*c %*d %*d %*d %*d %*d %*u %lf %*u %lf %*u %lf %lf", &fields.minor_faults,
                    &fields.major_faults, &fields.user, &fields.system) != 4) {
        return {};
    }
    return fields;
}

/// The number that the name of a file is; none if it is not.
std::optional<pid_t> number_of(const std::filesystem::path& file)
{
    const std::string name = file.filename().string();
    pid_t number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    return error == std::errc{} && end == name.data() + name.size() ? std::optional{number}
                                                                    : std::nullopt;
}

/// The socket that listens at the port, as the links of its descriptors have it.
std::optional<std::string> find_socket(unsigned port)
{
    constexpr unsigned listening = 0x0A;
    for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
        std::ifstream file{table};
        for (std::string line; std::getline(file, line);) {
            unsigned local = 0;
            unsigned state = 0;
            unsigned long node = 0;
            if (std::sscanf(line.c_str(), " %*u: %*[^:]:%x %*[^:]:%*x %x %*s %*s %*s %*u %*u %lu",
                            &local, &state, &node) == 3 &&
                local == port && state == listening) {
                return "socket:[" + std::to_string(node) + "]";
            }
        }
    }
    return std::nullopt;
}

/// What is in a folder of /proc: as far as it is ours to see, and until the process ends.
std::vector<std::filesystem::path> entries_of(const std::string& folder)
{
    std::vector<std::filesystem::path> entries;
    std::error_code error;
    std::filesystem::directory_iterator at{folder, error};
    while (!error && at != std::filesystem::directory_iterator{}) {
        entries.push_back(at->path());
        at.increment(error);
    }
    return entries;
}

/// Those of them whose names are numbers.
std::vector<pid_t> numbers_in(const std::string& folder)
{
    std::vector<pid_t> numbers;
    for (const std::filesystem::path& entry : entries_of(folder)) {
        if (const auto number = number_of(entry)) {
            numbers.push_back(*number);
        }
    }
    return numbers;
}

bool has_open(pid_t process, const std::string& socket)
{
    const auto descriptors = entries_of(file_of(process, "fd"));
    return std::any_of(descriptors.begin(), descriptors.end(), [&](const auto& descriptor) {
        std::error_code ignored; // it has been closed
        return std::filesystem::read_symlink(descriptor, ignored) == socket;
    });
}

bool is_of_this_machine(const std::string& host)
{
    return host == "localhost" || host.starts_with("127.") || host == "[::1]";
}

} // namespace

double processor_time(pid_t process)
{
    // Of each thread in nanoseconds; the sum of all is known in ticks of some milliseconds only.
    double nanoseconds = 0;
    for (const pid_t thread : threads_of(process)) {
        std::ifstream file{file_of(process, "task/") + std::to_string(thread) + "/schedstat"};
        double one = 0;
        file >> one;
        nanoseconds += one;
    }
    if (nanoseconds > 0) {
        return nanoseconds / 1e9;
    }
    const auto fields = stat_of(process);
    return (fields.user + fields.system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

double thread_time_ms()
{
    std::timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) / 1e6;
}

double page_faults(pid_t process)
{
    const auto fields = stat_of(process);
    return fields.minor_faults + fields.major_faults;
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

double own_memory_mb(pid_t process)
{
    constexpr double kib_per_mb = 1e6 / 1024;
    // The counters of `status` are hundreds of kilobytes late.
    std::ifstream file{file_of(process, "smaps_rollup")};
    double kib = 0;
    for (std::string line; std::getline(file, line);) {
        if (std::sscanf(line.c_str(), "Anonymous: %lf kB", &kib) == 1) {
            break;
        }
    }
    return kib / kib_per_mb;
}

void forget_peak(pid_t process)
{
    std::ofstream{file_of(process, "clear_refs")} << "5";
}

std::vector<pid_t> threads_of(pid_t process)
{
    return numbers_in(file_of(process, "task"));
}

std::optional<pid_t> find_listener(const std::string& url)
{
    constexpr std::string_view scheme = "opc.tcp://";
    const std::size_t begin = url.starts_with(scheme) ? scheme.size() : 0;
    const std::size_t end = std::min(url.find('/', begin), url.size());
    const std::size_t colon = url.rfind(':', end);
    unsigned port = 4840;
    std::size_t host_end = end;
    if (colon != std::string::npos && colon > begin && url[end - 1] != ']') {
        host_end = colon;
        std::from_chars(url.data() + colon + 1, url.data() + end, port);
    }
    const auto socket =
        is_of_this_machine(url.substr(begin, host_end - begin)) ? find_socket(port) : std::nullopt;
    if (!socket) {
        return std::nullopt;
    }
    const auto processes = numbers_in("/proc");
    const auto found = std::find_if(processes.begin(), processes.end(),
                                    [&](pid_t process) { return has_open(process, *socket); });
    return found != processes.end() ? std::optional{*found} : std::nullopt;
}

} // namespace busbar::bench

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <sys/types.h>

namespace busbar::bench {

/// What a server took for one request, all of its threads together, whatever else it does included.
struct ServerCost {
    double processor_us{0};
    double page_faults{0};
    /// None where the system does not let us count them: it lets those who may trace.
    std::optional<double> system_calls;
};

/// Counts what a process of this machine takes while a load runs.
class ServerMeter {
public:
    /// Of no process for 0. Threads that it starts later count with processor time and page faults
    /// alone.
    explicit ServerMeter(pid_t process);
    ServerMeter(const ServerMeter&) = delete;
    ServerMeter& operator=(const ServerMeter&) = delete;
    ~ServerMeter();

    void begin();
    /// What it took since begin(), shared by so many requests; none of no process.
    [[nodiscard]] std::optional<ServerCost> end(std::size_t requests) const;

private:
    [[nodiscard]] double count_calls() const;

    pid_t process_;
    std::vector<int> counters_; // of system calls, one for each thread
    double processor_{0};       // seconds
    double faults_{0};
    double calls_{0};
};

} // namespace busbar::bench

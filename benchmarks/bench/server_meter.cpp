#include "server_meter.hpp"

#include <cstdint>
#include <fstream>
#include <string>

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "process.hpp"

namespace busbar::bench {

namespace {

/// The number that the kernel gives to the begin of a system call; 0 if it is not ours to see.
std::uint64_t tracepoint()
{
    std::uint64_t id = 0;
    for (const char* folder : {"/sys/kernel/tracing", "/sys/kernel/debug/tracing"}) {
        std::ifstream{std::string{folder} + "/events/raw_syscalls/sys_enter/id"} >> id;
        if (id != 0) {
            break;
        }
    }
    return id;
}

int open_counter(std::uint64_t event, pid_t thread)
{
    perf_event_attr attributes{};
    attributes.type = PERF_TYPE_TRACEPOINT;
    attributes.size = sizeof attributes;
    attributes.config = event;
    return static_cast<int>(
        ::syscall(SYS_perf_event_open, &attributes, thread, -1, -1, PERF_FLAG_FD_CLOEXEC));
}

} // namespace

ServerMeter::ServerMeter(pid_t process) : process_{process}
{
    const std::uint64_t event = process == 0 ? 0 : tracepoint();
    for (const pid_t thread : event == 0 ? std::vector<pid_t>{} : threads_of(process)) {
        if (const int counter = open_counter(event, thread); counter >= 0) {
            counters_.push_back(counter);
        }
    }
}

ServerMeter::~ServerMeter()
{
    for (const int counter : counters_) {
        ::close(counter);
    }
}

double ServerMeter::count_calls() const
{
    double calls = 0;
    for (const int counter : counters_) {
        std::uint64_t count = 0;
        if (::read(counter, &count, sizeof count) == sizeof count) {
            calls += static_cast<double>(count);
        }
    }
    return calls;
}

void ServerMeter::begin()
{
    if (process_ != 0) {
        processor_ = processor_time(process_);
        faults_ = page_faults(process_);
        calls_ = count_calls();
    }
}

std::optional<ServerCost> ServerMeter::end(std::size_t requests) const
{
    if (process_ == 0 || requests == 0) {
        return std::nullopt;
    }
    const auto count = static_cast<double>(requests);
    ServerCost cost{(processor_time(process_) - processor_) * 1e6 / count,
                    (page_faults(process_) - faults_) / count, std::nullopt};
    if (!counters_.empty()) {
        cost.system_calls = (count_calls() - calls_) / count;
    }
    return cost;
}

} // namespace busbar::bench

#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <ctime>

#include <busbar/model/address_space.hpp>

namespace busbar::bench {

/// Processor time of the process, which has one thread: what else the machine does does not count.
struct Clock {
    using duration = std::chrono::nanoseconds;
    using rep = duration::rep;
    using period = duration::period;
    using time_point = std::chrono::time_point<Clock, duration>;
    static constexpr bool is_steady = true;
    [[nodiscard]] static time_point now()
    {
        std::timespec time{};
        ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
        return time_point{std::chrono::seconds{time.tv_sec} + duration{time.tv_nsec}};
    }
};

/// Microseconds.
[[nodiscard]] inline double elapsed_us(Clock::time_point since)
{
    return std::chrono::duration<double, std::micro>{Clock::now() - since}.count();
}

/// Bytes that the process holds on the heap.
[[nodiscard]] std::size_t heap_in_use();

/// What a machine's model looks like: below Objects lines of 100 objects each, in each of them 100
/// variables; NodeIds are texts such as "Line007.Cell042.Value013".
constexpr std::uint32_t values_per_cell = 100;
constexpr std::uint32_t cells_per_line = 100;

/// Adds that many variables, in namespace 1.
void add_machine(model::AddressSpace& space, std::uint32_t variables);
/// The NodeId of a variable of add_machine.
[[nodiscard]] NodeId machine_variable(std::uint32_t number);

/// How long it takes to make an address space of constant nodes.
struct Start {
    double microseconds{0};
    std::size_t nodes{0};
};
[[nodiscard]] Start measure_start(const model::StaticNodes& nodes);
/// The bytes of all tables, which lie in read-only memory.
[[nodiscard]] std::size_t constant_bytes(const model::StaticNodes& nodes);

} // namespace busbar::bench

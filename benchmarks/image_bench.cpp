// What readers cost a PLC task: the time its publish takes, and how late its scans begin, without
// and with busy clients.

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include <busbar/controller/plc.hpp>
#include <busbar/controller/plc_task.hpp>

#include "command_line/program_options.hpp"

using namespace busbar;
using namespace busbar::controller;

namespace {

using Clock = std::chrono::steady_clock;

class SystemClock final : public WallClock {
public:
    DateTime now() const override
    {
        using Ticks = std::chrono::duration<std::int64_t, std::ratio<1, 10'000'000>>;
        const auto since = std::chrono::system_clock::now().time_since_epoch();
        return DateTime::from_unix_ticks(std::chrono::duration_cast<Ticks>(since).count());
    }
};

constexpr int realtime_priority = 50;

double microseconds(Duration duration)
{
    return std::chrono::duration<double, std::micro>{duration}.count();
}

/// Threads that pin the image and read all of it, over and over.
class Readers {
public:
    Readers(const server::ProcessImage& image, unsigned count)
    {
        for (unsigned i = 0; i < count; ++i) {
            threads_.emplace_back([this, &image] { read(image); });
        }
    }
    ~Readers()
    {
        done_ = true;
        for (std::thread& thread : threads_) {
            thread.join();
        }
    }
    [[nodiscard]] std::uint64_t reads() const { return reads_; }

private:
    void read(const server::ProcessImage& image)
    {
        const auto count = static_cast<std::uint32_t>(image.layout().size());
        std::vector<server::ReadSlot> slots(count);
        while (!done_) {
            const server::ImagePin pin = image.pin();
            for (std::uint32_t i = 0; pin && i < count; ++i) {
                pin.read(i, slots[i]);
            }
            reads_ += pin ? 1 : 0;
        }
    }

    std::atomic<bool> done_{false};
    std::atomic<std::uint64_t> reads_{0};
    std::vector<std::thread> threads_;
};

std::unique_ptr<Plc> make_plc(std::uint32_t variable_count)
{
    PlcConfig config;
    PlcVariable variable;
    variable.name = "Bulk";
    variable.type = BuiltInType::Int16;
    variable.count = variable_count;
    config.variables.push_back(variable);
    PlcProgram program;
    program.target = "Bulk";
    config.programs.push_back(program);
    server::ImageOptions options;
    options.max_pins = 16;
    return std::move(Plc::create(config, options).value());
}

/// Of variables that stay in a runtime's memory, all `step` numbers.
std::shared_ptr<server::ProcessImage> make_gathered(std::span<std::int16_t> memory,
                                                    std::size_t step)
{
    server::ImageLayout layout;
    for (std::size_t i = 0; i < memory.size(); i += step) {
        static_cast<void>(layout.add(
            {.type = BuiltInType::Int16, .runtime = std::as_writable_bytes(memory.subspan(i, 1))}));
    }
    server::ImageOptions options;
    options.max_pins = 16;
    return server::ProcessImage::create(std::move(layout), options);
}

/// The median of publishes of which each finds `changed` other variables with another value: their
/// source timestamps are those of the scan then. In us.
double publish_cost(server::ProcessImage& image, std::uint32_t changed)
{
    constexpr int scans = 500;
    std::vector<Duration> times(scans);
    std::uint32_t next = 0;
    for (int scan = 0; scan < scans; ++scan) {
        for (std::uint32_t i = 0; i < changed; ++i, next = (next + 1) % image.size()) {
            ++image.memory().value<std::int16_t>(next);
        }
        const auto begin = Clock::now();
        image.begin_scan();
        image.publish(DateTime::from_unix_seconds(scan + 1));
        times[static_cast<std::size_t>(scan)] = Clock::now() - begin;
    }
    std::nth_element(times.begin(), times.begin() + scans / 2, times.end());
    return microseconds(times[scans / 2]);
}

/// Publishes of variables that change, in rounds that take turns.
void measure_changes(std::uint32_t variable_count)
{
    constexpr int rounds = 7;
    server::ImageLayout layout;
    for (std::uint32_t i = 0; i < variable_count; ++i) {
        static_cast<void>(layout.add({.type = BuiltInType::Int16}));
    }
    const auto image = server::ProcessImage::create(std::move(layout), {});
    const std::array<std::uint32_t, 4> changed{0, variable_count / 100, variable_count / 2,
                                               variable_count};
    std::array<std::vector<double>, changed.size()> costs;
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < changed.size(); ++i) {
            costs[i].push_back(publish_cost(*image, changed[i]));
        }
    }
    for (std::size_t i = 0; i < changed.size(); ++i) {
        std::sort(costs[i].begin(), costs[i].end());
        std::printf("%8u %12.2f %12.2f\n", changed[i], costs[i].front(), costs[i][rounds / 2]);
    }
}

std::vector<Duration> time_scans(server::ProcessImage& image)
{
    std::vector<Duration> times(20'000);
    for (Duration& time : times) {
        const auto begin = Clock::now();
        image.begin_scan();
        image.publish(DateTime{});
        time = Clock::now() - begin;
    }
    std::sort(times.begin(), times.end());
    return times;
}

/// The exchange alone, in a thread like the task's.
void measure_publish(server::ProcessImage& image, unsigned reader_count)
{
    image.publish(DateTime{});
    const Readers readers{image, reader_count};
    while (reader_count != 0 && readers.reads() == 0) {
        std::this_thread::yield();
    }
    std::vector<Duration> times;
    std::thread{[&] {
        sched_param parameters{};
        parameters.sched_priority = realtime_priority;
        // Without the right to it the worst time is that of the other threads' time slices.
        static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters));
        times = time_scans(image);
    }}.join();
    std::printf("%8u %12.2f %12.2f %12.2f\n", reader_count, microseconds(times[times.size() / 2]),
                microseconds(times[times.size() / 100 * 99]), microseconds(times.back()));
}

/// A task with a cycle of 1 ms, so that there are many scans to be late.
void measure_task(unsigned reader_count, std::uint32_t variable_count, int priority)
{
    const auto plc = make_plc(variable_count);
    const SystemClock clock;
    PlcTask task{*plc, clock, std::chrono::milliseconds{1}, priority};
    task.start();
    PlcTask::Statistics statistics;
    {
        const Readers readers{*plc->image(), reader_count};
        std::this_thread::sleep_for(std::chrono::seconds{5});
        statistics = task.statistics();
    }
    task.stop();
    std::printf("%8u %10s %10llu %10llu %12.2f %12.2f\n", reader_count,
                task.realtime_priority() != 0 ? "real-time" : "normal",
                static_cast<unsigned long long>(statistics.scans),
                static_cast<unsigned long long>(statistics.missed_cycles),
                microseconds(statistics.worst_lateness), microseconds(statistics.worst_scan));
}

} // namespace

int main(int argc, char** argv)
{
    std::uint32_t variable_count = 25'000;
    CLI::App app{"Measures what readers of a process image cost a PLC task: the time of its "
                 "publish, and how late its scans begin, without and with busy clients."};
    app.add_option("variables", variable_count, "Int16 variables of the image")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    command_line::add_program_options(app, "busbar-image-bench");
    CLI11_PARSE(app, argc, argv);
    std::printf("Process image of %u Int16 variables, %u processors\n", variable_count,
                std::thread::hardware_concurrency());

    std::printf("\nScan's edge and publish, as fast as they go\n%8s %12s %12s %12s\n", "readers",
                "median us", "99 % us", "worst us");
    const auto plc = make_plc(variable_count);
    for (const unsigned readers : {0U, 1U, 10U}) {
        measure_publish(*plc->image(), readers);
    }

    std::printf("\nPublish of variables that change, other ones in each scan\n%8s %12s %12s\n",
                "changed", "least us", "median us");
    measure_changes(variable_count);

    std::vector<std::int16_t> memory(std::size_t{2} * variable_count);
    std::printf("\nGathered from a runtime's memory, the variables side by side\n");
    measure_publish(*make_gathered(std::span{memory}.first(variable_count), 1), 0);
    std::printf("\nGathered, each variable by itself\n");
    measure_publish(*make_gathered(memory, 2), 0);

    std::printf("\nA task with a cycle of 1 ms, 5 s each\n%8s %10s %10s %10s %12s %12s\n",
                "readers", "priority", "scans", "missed", "late us", "scan us");
    for (const int priority : {realtime_priority, 0}) {
        for (const unsigned readers : {0U, 1U, 10U}) {
            measure_task(readers, variable_count, priority);
        }
    }
    return 0;
}

// What readers cost a PLC task: the time its publish takes, and how late its scans begin, without
// and with busy clients.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <busbar/controller/plc.hpp>
#include <busbar/controller/plc_task.hpp>

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
        return DateTime::from_unix(std::chrono::duration_cast<Ticks>(since));
    }
};

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

/// The publish alone, scan after scan.
void measure_publish(server::ProcessImage& image, unsigned reader_count)
{
    constexpr std::size_t scans = 20'000;
    const SystemClock clock;
    image.publish(clock.now());
    const Readers readers{image, reader_count};
    std::vector<Duration> times(scans);
    for (Duration& time : times) {
        const auto begin = Clock::now();
        image.begin_scan();
        image.publish(DateTime{});
        time = Clock::now() - begin;
    }
    std::sort(times.begin(), times.end());
    std::printf("%8u %12.2f %12.2f %12.2f %12llu\n", reader_count, microseconds(times[scans / 2]),
                microseconds(times[scans / 100 * 99]), microseconds(times.back()),
                static_cast<unsigned long long>(readers.reads()));
}

/// A task with a cycle of 1 ms, so that there are many scans to be late.
void measure_task(unsigned reader_count, std::uint32_t variable_count, unsigned seconds)
{
    const auto plc = make_plc(variable_count);
    const SystemClock clock;
    PlcTask task{*plc, clock, std::chrono::milliseconds{1}};
    task.start();
    PlcTask::Statistics statistics;
    {
        const Readers readers{*plc->image(), reader_count};
        std::this_thread::sleep_for(std::chrono::seconds{seconds});
        statistics = task.statistics();
    }
    task.stop();
    std::printf("%8u %12llu %12llu %12.2f %12.2f\n", reader_count,
                static_cast<unsigned long long>(statistics.scans),
                static_cast<unsigned long long>(statistics.missed_cycles),
                microseconds(statistics.worst_lateness), microseconds(statistics.worst_scan));
}

} // namespace

int main(int argc, char** argv)
{
    const unsigned long asked = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 25'000;
    const auto variable_count = static_cast<std::uint32_t>(std::clamp(asked, 1UL, 1'000'000UL));
    std::printf("Process image of %u Int16 variables, %u processors\n", variable_count,
                std::thread::hardware_concurrency());

    std::printf("\nScan's edge and publish, as fast as they go\n%8s %12s %12s %12s %12s\n",
                "readers", "median us", "99 % us", "worst us", "reads");
    const auto plc = make_plc(variable_count);
    for (const unsigned readers : {0U, 1U, 10U}) {
        measure_publish(*plc->image(), readers);
    }

    std::printf("\nA task with a cycle of 1 ms, 5 s each\n%8s %12s %12s %12s %12s\n", "readers",
                "scans", "missed", "late us", "scan us");
    for (const unsigned readers : {0U, 1U, 10U}) {
        measure_task(readers, variable_count, 5);
    }
    return 0;
}

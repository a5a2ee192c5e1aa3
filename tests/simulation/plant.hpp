#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <busbar/server/memory_source.hpp>
#include <busbar/server/process_image.hpp>
#include <busbar/server/server.hpp>

#include "harness_names.hpp"
#include "late_source.hpp"

namespace busbar::test {

/// What the clients of a simulation watch: variables that only count, so that whoever misses a
/// value sees it, and events with numbers. Most of the time little happens; then much at once, and
/// now and then a storm in which some variables change faster than a client can take them.
class Plant {
public:
    /// A counter of the process image counts at most once in a scan and one of the memory source
    /// at most once in `memory_pause`, so that items that are sampled often enough miss nothing.
    /// Those of a storm count in each of its scans.
    enum class Kind : std::uint8_t { Scan, Memory, Event, Storm };
    static constexpr std::size_t counters = 8;
    static constexpr Duration memory_pause{std::chrono::seconds{21}};
    static constexpr Duration scan_cycle{std::chrono::milliseconds{100}};
    static constexpr Duration storm_cycle{std::chrono::milliseconds{50}};

    Plant(Scheduler& scheduler, const WallClock& clock, Chance chance);

    /// Once, before start(). The server must outlive what happens, the plant the server.
    void serve(server::Server& server);
    void start();
    void stop();

    [[nodiscard]] NodeId node(Kind kind, std::size_t index) const;
    /// What was counted up to now; of events the last number.
    [[nodiscard]] std::int64_t count(Kind kind, std::size_t index) const;
    /// When that number was counted, which is not more than count(). Of numbers that are long past
    /// it is when a later one was.
    [[nodiscard]] TimePoint time_of(Kind kind, std::size_t index, std::int64_t number) const;

private:
    /// When the last numbers were counted.
    class Times {
    public:
        void add(std::int64_t number, TimePoint time) { times_[place(number)] = time; }
        [[nodiscard]] TimePoint of(std::int64_t number, std::int64_t last) const
        {
            const auto kept = static_cast<std::int64_t>(times_.size());
            return times_[place(std::max(number, last - kept + 1))];
        }

    private:
        std::array<TimePoint, 128> times_{};
        [[nodiscard]] std::size_t place(std::int64_t number) const
        {
            return static_cast<std::size_t>(number) % times_.size();
        }
    };

    [[nodiscard]] const Times& times(Kind kind, std::size_t index) const
    {
        return times_[static_cast<std::size_t>(kind) * counters + index];
    }
    void counted(Kind kind, std::size_t index, std::int64_t number);
    void add_variable(Kind kind, std::size_t index, std::uint32_t source, std::uint64_t handle);
    void scan();
    void count_memory();
    void raise();
    void storm();

    Scheduler* scheduler_;
    const WallClock* clock_;
    Chance chance_;
    server::MemorySource memory_;
    LateSource late_memory_;
    std::vector<std::uint32_t> scanned_;
    std::shared_ptr<server::ProcessImage> image_;
    server::ImageSource image_source_;
    std::vector<std::uint32_t> stormy_;
    std::shared_ptr<server::ProcessImage> storm_image_;
    server::ImageSource storm_source_;
    std::vector<Times> times_;
    std::vector<std::int32_t> remembered_;
    std::vector<TimePoint> next_count_;
    std::int64_t raised_{0};
    int burst_{0};
    int storm_{0};
    server::Server* server_{nullptr};
    Alarm scan_alarm_;
    Alarm memory_alarm_;
    Alarm event_alarm_;
    Alarm storm_alarm_;
};

} // namespace busbar::test

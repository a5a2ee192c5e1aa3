#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

#include <busbar/controller/plc.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>

namespace busbar::controller {

/// Runs a PLC's scans in a thread of its own, at equal intervals.
///
/// The thread asks the system for SCHED_FIFO with `realtime_priority`, 1 to 99 or 0 for none; it
/// takes a privilege (CAP_SYS_NICE, or RLIMIT_RTPRIO as high); realtime_priority() says what was
/// granted. Without it, anything that runs on the machine can make a scan begin late: see
/// keep_priority().
///
/// `plc` and `clock` must outlive it; from start() to stop() nobody else may use the scan's side of
/// `plc`. start() and stop() belong to one thread.
class BUSBAR_API PlcTask {
public:
    /// Above most threads of a system, below those of its drivers.
    static constexpr int usual_priority = 10;

    PlcTask(Plc& plc, const WallClock& clock, Duration cycle = std::chrono::milliseconds{20},
            int realtime_priority = usual_priority);
    PlcTask(const PlcTask&) = delete;
    PlcTask& operator=(const PlcTask&) = delete;
    ~PlcTask() { stop(); }

    /// Runs `action` in the task's thread after each scan, with the scan's time. It may take what
    /// is left of the cycle and no longer. What it throws goes to `log`, which may be null and must
    /// outlive the task; the scans go on. Before start().
    void after_scan(std::function<void(DateTime time)> action, LogSink* log = nullptr)
    {
        after_scan_ = std::move(action);
        log_ = log;
    }
    /// Within such an action: the scans are those of `plc` from the next one on, and the one before
    /// is not used any more, not even halted. Outlives the task, as that one.
    void replace(Plc& plc) { plc_ = &plc; }
    /// Tasks that start later have the priority that the calling thread has now, even if it, or who
    /// starts them, gives way to others by then: a thread has the priority of its maker and cannot
    /// raise it. The first call counts. Any thread.
    static void keep_priority();

    /// The first scan begins at once.
    void start();
    /// Waits for a scan that runs, then halts the PLC.
    void stop();

    struct Statistics {
        std::uint64_t scans{0};
        /// Cycles that were left out because the scan before was too long or began too late.
        std::uint64_t missed_cycles{0};
        /// How much later than planned a scan began, and how long one took, at worst.
        Duration worst_lateness{0};
        Duration worst_scan{0};
    };
    /// Since start(); from any thread.
    [[nodiscard]] Statistics statistics() const;
    [[nodiscard]] Duration cycle() const { return cycle_; }
    /// What the system granted, since start(): 1 to 99, or 0 for an ordinary thread. Any thread.
    [[nodiscard]] int realtime_priority() const { return granted_priority_; }

private:
    void run();
    void begin();
    void scan(TimePoint planned, TimePoint begin, Duration elapsed);

    Plc* plc_;
    const WallClock* clock_;
    Duration cycle_;
    int wanted_priority_;
    std::function<void(DateTime)> after_scan_;
    LogSink* log_{nullptr};
    std::thread thread_;
    /// Guards these. The task holds it only while it waits for its next cycle.
    std::mutex mutex_;
    std::condition_variable changed_;
    bool has_begun_{false};
    bool stopping_{false};

    std::atomic<std::uint64_t> scans_{0};
    std::atomic<std::uint64_t> missed_cycles_{0};
    std::atomic<Duration::rep> worst_lateness_{0};
    std::atomic<Duration::rep> worst_scan_{0};
    std::atomic<int> granted_priority_{0};
};

} // namespace busbar::controller

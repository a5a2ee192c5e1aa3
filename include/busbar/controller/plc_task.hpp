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

/// Makes threads with the priority that its creator had when it was made, even if that, or the
/// thread that asks for one, has lowered its own by then: a thread inherits the priority of its
/// creator and cannot raise it. Thread-safe.
class BUSBAR_API ThreadMaker {
public:
    ThreadMaker() : thread_{[this] { run(); }} {}
    ThreadMaker(const ThreadMaker&) = delete;
    ThreadMaker& operator=(const ThreadMaker&) = delete;
    /// The threads that it made continue.
    ~ThreadMaker();

    /// Throws the exceptions of std::thread.
    [[nodiscard]] std::thread make(std::function<void()> body);

private:
    void run();

    std::mutex mutex_;
    std::condition_variable changed_;
    /// The job to start; empty between jobs.
    std::function<void()> job_;
    bool is_over_{false};
    std::thread thread_;
};

/// Runs a PLC's scans in its own thread, at equal intervals.
///
/// The thread requests SCHED_FIFO with `realtime_priority`, 1 to 99 or 0 for none, from the system;
/// that requires a privilege (CAP_SYS_NICE, or RLIMIT_RTPRIO as high); realtime_priority() returns
/// what was granted. Without it, anything that runs on the machine can delay a scan: see
/// ThreadMaker.
///
/// `plc` and `clock` must outlive it; from start() to stop() no other code may use the scan's side
/// of `plc`. start() and stop() belong to one thread.
class BUSBAR_API PlcTask {
public:
    /// Above most threads of a system, below those of its drivers.
    static constexpr int usual_priority = 10;

    /// `threads` makes its thread, if it is not null, and must outlive it then.
    PlcTask(Plc& plc, const WallClock& clock, Duration cycle = std::chrono::milliseconds{20},
            int realtime_priority = usual_priority, ThreadMaker* threads = nullptr);
    PlcTask(const PlcTask&) = delete;
    PlcTask& operator=(const PlcTask&) = delete;
    ~PlcTask() { stop(); }

    /// Runs `action` in the task's thread after each scan, with the scan's time. It may take the
    /// rest of the cycle and no longer. Its exceptions go to `log`, which may be null and must
    /// outlive the task; the scans continue. Call it before start().
    void after_scan(std::function<void(DateTime time)> action, LogSink* log = nullptr)
    {
        after_scan_ = std::move(action);
        log_ = log;
    }
    /// Within such an action: from the next scan on `plc` is scanned, and the previous one is not
    /// used any more, not even halted. `plc` must outlive the task too.
    void replace(Plc& plc) { plc_ = &plc; }

    /// Returns when the first scan has ended.
    void start();
    /// Waits for a running scan, then halts the PLC.
    void stop();

    /// The scans that ran, and those that were late.
    struct Statistics {
        std::uint64_t scans{0};
        /// Cycles that were skipped because the previous scan took too long or began too late.
        std::uint64_t missed_cycles{0};
        /// The longest delay of a scan's beginning, and the longest duration of a scan.
        Duration worst_lateness{0};
        Duration worst_scan{0};
    };
    /// Since start(); from any thread.
    [[nodiscard]] Statistics statistics() const;
    [[nodiscard]] Duration cycle() const { return cycle_; }
    /// The priority granted by the system, since start(): 1 to 99, or 0 for an ordinary thread. Any
    /// thread.
    [[nodiscard]] int realtime_priority() const { return granted_priority_; }

private:
    void run();
    void ask_for_priority();
    void scan(TimePoint planned, TimePoint begin, Duration elapsed);

    Plc* plc_;
    const WallClock* clock_;
    Duration cycle_;
    int wanted_priority_;
    ThreadMaker* threads_;
    std::function<void(DateTime)> after_scan_;
    LogSink* log_{nullptr};
    std::thread thread_;
    /// Guards these. The task holds it only while it waits for its next cycle.
    std::mutex mutex_;
    std::condition_variable changed_;
    bool has_scanned_{false};
    bool stopping_{false};

    std::atomic<std::uint64_t> scans_{0};
    std::atomic<std::uint64_t> missed_cycles_{0};
    std::atomic<Duration::rep> worst_lateness_{0};
    std::atomic<Duration::rep> worst_scan_{0};
    std::atomic<int> granted_priority_{0};
};

} // namespace busbar::controller

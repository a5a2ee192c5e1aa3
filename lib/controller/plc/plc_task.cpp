#include <busbar/controller/plc_task.hpp>

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::controller {

namespace {

TimePoint steady_now()
{
    return std::chrono::steady_clock::now();
}

/// Gives the calling thread a real-time priority; false if the system does not allow it.
bool set_realtime(int priority)
{
    sched_param parameters{};
    parameters.sched_priority = priority;
    return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
}

/// Only the task's thread writes these.
template <typename T>
void raise(std::atomic<T>& worst, T value)
{
    if (value > worst.load(std::memory_order_relaxed)) {
        worst.store(value, std::memory_order_relaxed);
    }
}

} // namespace

PlcTask::PlcTask(Plc& plc, const WallClock& clock, Duration cycle, int realtime_priority,
                 ThreadMaker* threads)
    : plc_{&plc}, clock_{&clock}, cycle_{std::max(cycle, Duration{1})},
      wanted_priority_{realtime_priority}, threads_{threads}
{
}

void PlcTask::start()
{
    if (thread_.joinable()) {
        return;
    }
    has_scanned_ = false;
    stopping_ = false;
    granted_priority_ = 0;
    scans_ = 0;
    missed_cycles_ = 0;
    worst_lateness_ = 0;
    worst_scan_ = 0;
    const auto body = [this] { run(); };
    thread_ = threads_ != nullptr ? threads_->make(body) : std::thread{body};
    std::unique_lock lock{mutex_};
    changed_.wait(lock, [this] { return has_scanned_; });
}

void PlcTask::stop()
{
    if (!thread_.joinable()) {
        return;
    }
    {
        const std::lock_guard lock{mutex_};
        stopping_ = true;
    }
    changed_.notify_one();
    thread_.join();
    plc_->halt();
}

void PlcTask::ask_for_priority()
{
    granted_priority_ =
        wanted_priority_ > 0 && set_realtime(wanted_priority_) ? wanted_priority_ : 0;
}

void PlcTask::run()
{
    ask_for_priority();
    TimePoint planned = steady_now();
    TimePoint before = planned;
    for (;;) {
        const TimePoint begin = steady_now();
        scan(planned, begin, begin - before);
        before = begin;
        planned += cycle_;
        // A task that is late by whole cycles skips them instead of catching up.
        if (const Duration behind = steady_now() - planned; behind > cycle_) {
            missed_cycles_.fetch_add(static_cast<std::uint64_t>(behind / cycle_),
                                     std::memory_order_relaxed);
            planned += behind / cycle_ * cycle_;
        }
        std::unique_lock lock{mutex_};
        if (!std::exchange(has_scanned_, true)) {
            changed_.notify_one(); // the thread that started it
        }
        if (changed_.wait_until(lock, planned, [this] { return stopping_; })) {
            return;
        }
    }
}

void PlcTask::scan(TimePoint planned, TimePoint begin, Duration elapsed)
{
    const DateTime now = clock_->now();
    plc_->scan(now, elapsed);
    raise(worst_lateness_, (begin - planned).count());
    raise(worst_scan_, Duration{steady_now() - begin}.count());
    scans_.fetch_add(1, std::memory_order_relaxed);
    if (after_scan_) {
        NullLog nowhere;
        busbar::detail::guarded(log_ != nullptr ? *log_ : nowhere, "after_scan action",
                                [&] { after_scan_(now); });
    }
}

PlcTask::Statistics PlcTask::statistics() const
{
    return {scans_.load(std::memory_order_relaxed), missed_cycles_.load(std::memory_order_relaxed),
            Duration{worst_lateness_.load(std::memory_order_relaxed)},
            Duration{worst_scan_.load(std::memory_order_relaxed)}};
}

} // namespace busbar::controller

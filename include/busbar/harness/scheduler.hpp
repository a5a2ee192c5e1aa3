#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/function_ref.hpp>

namespace busbar::harness {

class Signal;

/// Real time for a scheduler, and what happens outside of its world meanwhile.
class BUSBAR_API Pacer {
public:
    Pacer() = default;
    Pacer(const Pacer&) = delete;
    Pacer& operator=(const Pacer&) = delete;
    virtual ~Pacer() = default;

    /// The time since the world began.
    [[nodiscard]] virtual TimePoint now() const = 0;
    /// Waits, at most until `end`, and returns as soon as something has happened, or after a
    /// millisecond. Called again and again on the scheduler's thread, also with a time that is
    /// over.
    virtual void wait_until(TimePoint end) = 0;
};

/// Virtual time: actions run in the order of their time and, at the same time, in the order in
/// which they were scheduled. Nothing else moves the time, so that the same actions make the same
/// run. One thread, except for now() and Signal::raise().
class BUSBAR_API Scheduler {
public:
    using Action = std::function<void()>;

    /// Called from any thread.
    [[nodiscard]] TimePoint now() const { return now_.load(std::memory_order_relaxed); }
    /// A time in the past means now, after the current action.
    void at(TimePoint time, Action action);
    /// Runs the action when `delay` has passed.
    void after(Duration delay, Action action) { at(now() + delay, std::move(action)); }

    /// Runs everything that is due until then; afterwards the time is `end`.
    void run_until(TimePoint end);
    /// Runs everything that is due until `time` has passed.
    void run_for(Duration time) { run_until(now() + time); }
    /// Runs likewise, but stops as soon as `condition` holds, which is called before the first
    /// action and after each. False, with the time at `end`, if it never did.
    bool run_until(FunctionRef<bool()> condition, TimePoint end);
    /// Runs the next action, whenever it is due; false if there is none.
    bool step();
    /// The time when the next action is due, which may be in the past; no_deadline if there is
    /// none. A driver in real time waits until then, or for less, and calls run_until() with its
    /// clock.
    [[nodiscard]] TimePoint next_due() const;
    /// From now on the time is that of `pacer`, which must outlive the scheduler or its successor:
    /// runs take as long as they say. Null: virtual time again.
    void set_pacer(Pacer* pacer) { pacer_ = pacer; }

private:
    friend class Signal;
    struct Entry {
        TimePoint time;
        std::uint64_t serial;
        Action action;
    };
    static bool is_later(const Entry& a, const Entry& b);
    void take_signals();
    bool run_next(TimePoint end);
    void run_first();
    /// Lets time pass; false if `end` has come.
    bool pace(TimePoint end);

    std::atomic<TimePoint> now_{TimePoint{}};
    std::uint64_t last_serial_{0};
    std::vector<Entry> entries_;
    std::vector<Signal*> signals_;
    Pacer* pacer_{nullptr};
};

/// Runs one action at a time, whose time can be changed. Cancels it when destroyed, which the
/// action itself must not do. The scheduler must outlive it.
class BUSBAR_API Alarm {
public:
    Alarm(Scheduler& scheduler, Scheduler::Action action);
    Alarm(const Alarm&) = delete;
    Alarm& operator=(const Alarm&) = delete;
    ~Alarm() { cancel(); }

    [[nodiscard]] bool is_set() const { return state_->due != no_deadline; }
    /// Replaces an earlier time; no_deadline is cancel().
    void set(TimePoint due);
    /// Sets the time that is `delay` from now.
    void set_after(Duration delay) { set(scheduler_->now() + delay); }
    void cancel() { state_->due = no_deadline; }

private:
    struct State {
        TimePoint due{no_deadline};
        /// The time at which the scheduler calls next.
        TimePoint asked{no_deadline};
        Scheduler::Action action;
    };
    static void wait(Scheduler& scheduler, const std::shared_ptr<State>& state);

    Scheduler* scheduler_;
    std::shared_ptr<State> state_;
};

/// Lets other threads, and code that must not be called back at once, trigger an action now: before
/// the next action, or when the next run begins. Raising it again before that makes no difference.
/// The action must not destroy it. The scheduler must outlive it.
class BUSBAR_API Signal {
public:
    Signal(Scheduler& scheduler, Scheduler::Action action);
    Signal(const Signal&) = delete;
    Signal& operator=(const Signal&) = delete;
    ~Signal();

    /// Called from any thread; neither blocks nor allocates.
    void raise() { is_raised_ = true; }

private:
    friend class Scheduler;

    Scheduler* scheduler_;
    Scheduler::Action action_;
    std::atomic<bool> is_raised_{false};
};

} // namespace busbar::harness

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

/// Virtual time: what is to happen, in the order of its time and, at the same time, in the order in
/// which it was asked for. Nothing else moves the time, so that the same actions make the same run.
/// One thread, except for Signal::raise().
class BUSBAR_API Scheduler {
public:
    using Action = std::function<void()>;

    [[nodiscard]] TimePoint now() const { return now_; }
    /// A time in the past means now, after the current action.
    void at(TimePoint time, Action action);
    void after(Duration delay, Action action) { at(now_ + delay, std::move(action)); }

    /// Runs everything that is due until then; afterwards it is `end`.
    void run_until(TimePoint end);
    void run_for(Duration time) { run_until(now_ + time); }
    /// The same, but stops as soon as `condition` holds, which is asked before the first action and
    /// after each. False, and it is `end`, if it never did.
    bool run_until(FunctionRef<bool()> condition, TimePoint end);
    /// Runs the next action, whenever that is due; false if there is none.
    bool step();
    /// When the next action is due, which may be in the past; no_deadline if there is none. A
    /// driver in real time waits until then, or for less, and calls run_until() with its clock.
    [[nodiscard]] TimePoint next_due() const;

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

    TimePoint now_{};
    std::uint64_t last_serial_{0};
    std::vector<Entry> entries_;
    std::vector<Signal*> signals_;
};

/// Does one thing at a time that can be changed. Forgets it when destroyed; that must not be done
/// by the action itself. The scheduler must outlive it.
class BUSBAR_API Alarm {
public:
    Alarm(Scheduler& scheduler, Scheduler::Action action);
    Alarm(const Alarm&) = delete;
    Alarm& operator=(const Alarm&) = delete;
    ~Alarm() { cancel(); }

    [[nodiscard]] bool is_set() const { return state_->due != no_deadline; }
    /// Replaces an earlier setting; no_deadline is cancel().
    void set(TimePoint due);
    void set_after(Duration delay) { set(scheduler_->now() + delay); }
    void cancel() { state_->due = no_deadline; }

private:
    struct State {
        TimePoint due{no_deadline};
        /// When the scheduler asks next.
        TimePoint asked{no_deadline};
        Scheduler::Action action;
    };
    static void wait(Scheduler& scheduler, const std::shared_ptr<State>& state);

    Scheduler* scheduler_;
    std::shared_ptr<State> state_;
};

/// Lets other threads, and whoever must not be called back at once, make something happen now:
/// before the next action, or when the next run begins. Raising it again before that makes no
/// difference. The action must not destroy it. The scheduler must outlive it.
class BUSBAR_API Signal {
public:
    Signal(Scheduler& scheduler, Scheduler::Action action);
    Signal(const Signal&) = delete;
    Signal& operator=(const Signal&) = delete;
    ~Signal();

    /// Any thread; neither blocks nor allocates.
    void raise() { is_raised_ = true; }

private:
    friend class Scheduler;

    Scheduler* scheduler_;
    Scheduler::Action action_;
    std::atomic<bool> is_raised_{false};
};

} // namespace busbar::harness

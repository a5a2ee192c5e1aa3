#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <busbar/core/clock.hpp>

#include "support/identity.hpp"

namespace busbar::test {

/// Virtual time: what is to happen, in the order of its time and, at the same time, of asking.
class Scheduler {
public:
    using Action = std::function<void()>;

    [[nodiscard]] TimePoint now() const { return now_; }
    void at(TimePoint time, Action action)
    {
        entries_.push_back({std::max(time, now_), ++last_serial_, std::move(action)});
        std::push_heap(entries_.begin(), entries_.end(), is_later);
    }
    void after(Duration delay, Action action) { at(now_ + delay, std::move(action)); }
    /// Lets all happen that is to happen until then.
    void run_until(TimePoint end)
    {
        while (!entries_.empty() && entries_.front().time <= end) {
            std::pop_heap(entries_.begin(), entries_.end(), is_later);
            const Entry entry = std::move(entries_.back());
            entries_.pop_back();
            now_ = entry.time;
            entry.action();
        }
        now_ = end;
    }
    void run_for(Duration time) { run_until(now_ + time); }

private:
    struct Entry {
        TimePoint time;
        std::uint64_t serial;
        Action action;
    };
    static bool is_later(const Entry& a, const Entry& b)
    {
        return std::pair{a.time, a.serial} > std::pair{b.time, b.serial};
    }

    TimePoint now_{};
    std::uint64_t last_serial_{0};
    std::vector<Entry> entries_;
};

/// Does one thing at a time that can be changed. Forgets it when destroyed. Must not be destroyed
/// by what it does.
class Alarm {
public:
    Alarm(Scheduler& scheduler, Scheduler::Action action)
        : scheduler_{&scheduler}, state_{std::make_shared<State>()}
    {
        state_->action = std::move(action);
    }
    Alarm(const Alarm&) = delete;
    Alarm& operator=(const Alarm&) = delete;
    ~Alarm() { cancel(); }

    [[nodiscard]] bool is_set() const { return state_->due != no_deadline; }
    void set(TimePoint due)
    {
        state_->due = due;
        wait(*scheduler_, state_);
    }
    void set_after(Duration delay) { set(scheduler_->now() + delay); }
    void cancel() { state_->due = no_deadline; }

private:
    struct State {
        TimePoint due{no_deadline};
        /// When the scheduler asks next.
        TimePoint asked{no_deadline};
        Scheduler::Action action;
    };
    static void wait(Scheduler& scheduler, const std::shared_ptr<State>& state)
    {
        if (state->due >= state->asked) {
            return;
        }
        const TimePoint time = state->asked = std::max(state->due, scheduler.now());
        scheduler.at(time, [&scheduler, state, time] {
            if (state->asked != time) {
                return; // it was set to an earlier time since
            }
            state->asked = no_deadline;
            if (state->due <= scheduler.now()) {
                state->due = no_deadline;
                state->action();
            } else {
                wait(scheduler, state);
            }
        });
    }

    Scheduler* scheduler_;
    std::shared_ptr<State> state_;
};

/// The time of day of a machine whose clock is set while it runs.
class JumpingClock final : public WallClock {
public:
    explicit JumpingClock(const Scheduler& scheduler) : scheduler_{&scheduler} {}
    [[nodiscard]] DateTime now() const override
    {
        const Duration time = scheduler_->now().time_since_epoch() + offset_;
        return {today.ticks + time.count() / 100};
    }
    void jump(Duration by) { offset_ += by; }

private:
    const Scheduler* scheduler_;
    Duration offset_{0};
};

} // namespace busbar::test

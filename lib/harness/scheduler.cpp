#include <busbar/harness/scheduler.hpp>

#include <algorithm>
#include <utility>

namespace busbar::harness {

bool Scheduler::is_later(const Entry& a, const Entry& b)
{
    return std::pair{a.time, a.serial} > std::pair{b.time, b.serial};
}

void Scheduler::at(TimePoint time, Action action)
{
    entries_.push_back({std::max(time, now()), ++last_serial_, std::move(action)});
    std::push_heap(entries_.begin(), entries_.end(), is_later);
}

bool Scheduler::run_next(TimePoint end)
{
    take_signals();
    if (pacer_ != nullptr) {
        return pace(end);
    }
    if (entries_.empty() || entries_.front().time > end) {
        return false;
    }
    run_first();
    return true;
}

bool Scheduler::pace(TimePoint end)
{
    now_ = std::max(now(), pacer_->now());
    const TimePoint due = std::min(now(), end);
    if (!entries_.empty() && entries_.front().time <= due) {
        run_first();
        pacer_->wait_until(due); // for what is ready, too
        return true;
    }
    if (now() >= end) {
        return false;
    }
    pacer_->wait_until(entries_.empty() ? end : std::min(end, entries_.front().time));
    return true;
}

void Scheduler::run_first()
{
    std::pop_heap(entries_.begin(), entries_.end(), is_later);
    const Entry entry = std::move(entries_.back());
    entries_.pop_back();
    now_ = std::max(now(), entry.time);
    entry.action();
}

void Scheduler::run_until(TimePoint end)
{
    while (run_next(end)) {
    }
    now_ = std::max(now(), end);
}

bool Scheduler::run_until(FunctionRef<bool()> condition, TimePoint end)
{
    while (!condition()) {
        if (!run_next(end)) {
            now_ = std::max(now(), end);
            return condition();
        }
    }
    return true;
}

bool Scheduler::step()
{
    return run_next(no_deadline);
}

TimePoint Scheduler::next_due() const
{
    for (const Signal* signal : signals_) {
        if (signal->is_raised_) {
            return now();
        }
    }
    return entries_.empty() ? no_deadline : entries_.front().time;
}

void Scheduler::take_signals()
{
    // An action may add and remove signals.
    for (std::size_t i = 0; i < signals_.size(); ++i) {
        if (signals_[i]->is_raised_.exchange(false)) {
            signals_[i]->action_();
        }
    }
}

Alarm::Alarm(Scheduler& scheduler, Scheduler::Action action)
    : scheduler_{&scheduler}, state_{std::make_shared<State>()}
{
    state_->action = std::move(action);
}

void Alarm::set(TimePoint due)
{
    state_->due = due;
    wait(*scheduler_, state_);
}

void Alarm::wait(Scheduler& scheduler, const std::shared_ptr<State>& state)
{
    if (state->due >= state->asked) {
        return;
    }
    const TimePoint time = state->asked = std::max(state->due, scheduler.now());
    scheduler.at(time, [&scheduler, state, time] {
        if (state->asked != time) {
            return; // it was set to an earlier time meanwhile
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

Signal::Signal(Scheduler& scheduler, Scheduler::Action action)
    : scheduler_{&scheduler}, action_{std::move(action)}
{
    scheduler.signals_.push_back(this);
}

Signal::~Signal()
{
    auto& signals = scheduler_->signals_;
    signals.erase(std::remove(signals.begin(), signals.end(), this), signals.end());
}

} // namespace busbar::harness

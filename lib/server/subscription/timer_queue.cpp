#include "timer_queue.hpp"

#include <algorithm>
#include <utility>

namespace busbar::server::detail {

void TimerQueue::put(Timer& timer, std::size_t place)
{
    heap_[place] = &timer;
    timer.place_ = place;
}

void TimerQueue::sift_up(Timer& timer, std::size_t place)
{
    while (place != 0) {
        const std::size_t parent = (place - 1) / 2;
        if (heap_[parent]->due_ <= timer.due_) {
            break;
        }
        put(*heap_[parent], place);
        place = parent;
    }
    put(timer, place);
}

void TimerQueue::sift_down(Timer& timer, std::size_t place)
{
    while (2 * place + 1 < heap_.size()) {
        std::size_t child = 2 * place + 1;
        if (child + 1 < heap_.size() && heap_[child + 1]->due_ < heap_[child]->due_) {
            ++child;
        }
        if (heap_[child]->due_ >= timer.due_) {
            break;
        }
        put(*heap_[child], place);
        place = child;
    }
    put(timer, place);
}

bool TimerQueue::has_place(const Timer& timer) const
{
    return timer.due_ != no_deadline || timer.is_expiring_ || current_ == &timer;
}

void TimerQueue::make_place()
{
    const std::size_t used = heap_.size() + expiring_.size();
    if (used >= heap_.capacity()) {
        heap_.reserve(2 * used + 1);
    }
}

void TimerQueue::set(Timer& timer, TimePoint due)
{
    if (due != no_deadline && !has_place(timer)) {
        make_place();
    }
    cancel(timer);
    if (due == no_deadline) {
        return;
    }
    heap_.push_back(&timer);
    timer.due_ = due;
    sift_up(timer, heap_.size() - 1);
}

void TimerQueue::cancel(Timer& timer)
{
    if (current_ == &timer) {
        current_ = nullptr;
    }
    if (std::exchange(timer.is_expiring_, false)) {
        std::replace(expiring_.begin(), expiring_.end(), &timer, static_cast<Timer*>(nullptr));
    }
    if (timer.due_ == no_deadline) {
        return;
    }
    timer.due_ = no_deadline;
    Timer& last = *heap_.back();
    heap_.pop_back();
    if (&last == &timer) {
        return;
    }
    const std::size_t place = timer.place_;
    if (place != 0 && last.due_ < heap_[(place - 1) / 2]->due_) {
        sift_up(last, place);
    } else {
        sift_down(last, place);
    }
}

/// Walks through the expiring timers, and keeps the rest if it does not reach the end.
class TimerQueue::Expiring {
public:
    explicit Expiring(TimerQueue& queue) : queue_{queue} {}
    Expiring(const Expiring&) = delete;
    Expiring& operator=(const Expiring&) = delete;
    ~Expiring()
    {
        auto& all = queue_.expiring_;
        all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(next_));
        queue_.current_ = nullptr;
        queue_.has_rest_ = !all.empty();
    }

    /// Returns false at the end.
    bool next(Timer*& timer)
    {
        if (next_ == queue_.expiring_.size()) {
            return false;
        }
        timer = std::exchange(queue_.expiring_[next_++], nullptr);
        queue_.current_ = timer;
        return true;
    }

private:
    TimerQueue& queue_;
    std::size_t next_{0};
};

void TimerQueue::expire(TimePoint now)
{
    std::erase(expiring_, nullptr); // of the remaining ones
    while (!heap_.empty() && heap_.front()->due_ <= now) {
        Timer* const timer = heap_.front();
        expiring_.push_back(timer);
        cancel(*timer);
        timer->is_expiring_ = true;
        has_rest_ = true;
    }
    std::stable_sort(expiring_.begin(), expiring_.end(),
                     [](const Timer* a, const Timer* b) { return a->rank() > b->rank(); });
    // A timer destroyed by another is cancelled by its destructor, which clears its place here.
    Expiring expiring{*this};
    for (Timer* timer = nullptr; expiring.next(timer);) {
        if (timer != nullptr) {
            timer->is_expiring_ = false;
            timer->expire(now);
        }
    }
}

} // namespace busbar::server::detail

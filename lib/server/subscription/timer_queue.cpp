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

void TimerQueue::set(Timer& timer, TimePoint due)
{
    cancel(timer);
    if (due == no_deadline) {
        return;
    }
    timer.due_ = due;
    heap_.push_back(&timer);
    sift_up(timer, heap_.size() - 1);
}

void TimerQueue::cancel(Timer& timer)
{
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

void TimerQueue::expire(TimePoint now)
{
    while (next_deadline() <= now) {
        Timer* const timer = heap_.front();
        cancel(*timer);
        timer->is_expiring_ = true;
        expiring_.push_back(timer);
    }
    std::stable_sort(expiring_.begin(), expiring_.end(),
                     [](const Timer* a, const Timer* b) { return a->rank() > b->rank(); });
    // One that ends another's life cancels it, which clears its place here.
    for (std::size_t i = 0; i < expiring_.size(); ++i) {
        if (Timer* const timer = std::exchange(expiring_[i], nullptr); timer != nullptr) {
            timer->is_expiring_ = false;
            timer->expire(now);
        }
    }
    expiring_.clear();
}

} // namespace busbar::server::detail

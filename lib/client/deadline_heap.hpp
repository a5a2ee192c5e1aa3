#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include <busbar/core/clock.hpp>

namespace busbar::client::detail {

/// `start + time`, or never if that is past what a TimePoint can tell.
[[nodiscard]] inline TimePoint deadline_after(TimePoint start, Duration time)
{
    return time >= no_deadline - start ? no_deadline : start + time;
}

/// Deadlines of what is kept elsewhere by its Id, the earliest first. One that counts no longer
/// stays until prune() drops it, so that neither costs an allocation of its own.
template <typename Id>
class DeadlineHeap {
public:
    void add(TimePoint deadline, Id id)
    {
        heap_.emplace_back(deadline, id);
        std::push_heap(heap_.begin(), heap_.end(), std::greater{});
    }
    /// To be called when one may count no longer: those for which `counts(deadline, id)` is false
    /// are dropped where they are the earliest, and all of them where they are more than the
    /// `count` that do.
    template <typename Counts>
    void prune(std::size_t count, Counts counts)
    {
        const auto is_over = [&](const Entry& entry) { return !counts(entry.first, entry.second); };
        if (heap_.size() > 2 * count + few) {
            std::erase_if(heap_, is_over);
            std::make_heap(heap_.begin(), heap_.end(), std::greater{});
        }
        while (!heap_.empty() && is_over(heap_.front())) {
            pop();
        }
    }
    /// The earliest; only after prune(), and if there is one.
    [[nodiscard]] Id first() const { return heap_.front().second; }
    void pop()
    {
        std::pop_heap(heap_.begin(), heap_.end(), std::greater{});
        heap_.pop_back();
    }
    /// The first deadline or, if there is none, no_deadline.
    [[nodiscard]] TimePoint next_deadline() const
    {
        return heap_.empty() ? no_deadline : heap_.front().first;
    }
    [[nodiscard]] std::size_t size() const { return heap_.size(); }

private:
    using Entry = std::pair<TimePoint, Id>;
    static constexpr std::size_t few = 32;

    std::vector<Entry> heap_;
};

} // namespace busbar::client::detail

#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include <busbar/core/clock.hpp>

namespace busbar::client::detail {

/// Returns `start + time`, or no_deadline if that exceeds the range of a TimePoint.
[[nodiscard]] inline TimePoint deadline_after(TimePoint start, Duration time)
{
    return time >= no_deadline - start ? no_deadline : start + time;
}

/// Deadlines of objects that are kept elsewhere, by Id, the earliest first. An obsolete one stays
/// until prune() drops it, so that neither needs an allocation of its own.
template <typename Id>
class DeadlineHeap {
public:
    void add(TimePoint deadline, Id id)
    {
        heap_.emplace_back(deadline, id);
        std::push_heap(heap_.begin(), heap_.end(), std::greater{});
    }
    /// Call it when a deadline may have become obsolete: those for which `counts(deadline, id)`
    /// returns false are dropped if they are the earliest, and all of them if they are more than
    /// the `count` valid ones.
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
    /// The Id of the earliest one; only after prune(), and if there is one.
    [[nodiscard]] Id first() const { return heap_.front().second; }
    void pop()
    {
        std::pop_heap(heap_.begin(), heap_.end(), std::greater{});
        heap_.pop_back();
    }
    /// Returns the first deadline, or no_deadline.
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

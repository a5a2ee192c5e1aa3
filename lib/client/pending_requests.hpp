#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include <busbar/core/clock.hpp>

namespace busbar::client::detail {

/// `start + time`, or never if that is past what a TimePoint can tell.
[[nodiscard]] inline TimePoint deadline_after(TimePoint start, Duration time)
{
    return time >= no_deadline - start ? no_deadline : start + time;
}

/// Requests under way on one connection, each with its own deadline.
class PendingRequests {
public:
    void add(std::uint32_t id, TimePoint deadline)
    {
        deadline_of_[id] = deadline;
        by_deadline_.insert({deadline, id});
    }
    /// False if there is none with that id.
    bool remove(std::uint32_t id)
    {
        const auto found = deadline_of_.find(id);
        if (found == deadline_of_.end()) {
            return false;
        }
        by_deadline_.erase({found->second, id});
        deadline_of_.erase(found);
        return true;
    }
    /// Removes one whose deadline has come, the earliest first.
    [[nodiscard]] std::optional<std::uint32_t> take_expired(TimePoint now)
    {
        if (by_deadline_.empty() || by_deadline_.begin()->first > now) {
            return std::nullopt;
        }
        const std::uint32_t id = by_deadline_.begin()->second;
        remove(id);
        return id;
    }
    /// Removes all, in the order of their deadlines.
    [[nodiscard]] std::vector<std::uint32_t> take_all()
    {
        std::vector<std::uint32_t> ids;
        for (const auto& [deadline, id] : std::exchange(by_deadline_, {})) {
            ids.push_back(id);
        }
        deadline_of_.clear();
        return ids;
    }
    [[nodiscard]] TimePoint next_deadline() const
    {
        return by_deadline_.empty() ? no_deadline : by_deadline_.begin()->first;
    }

private:
    std::unordered_map<std::uint32_t, TimePoint> deadline_of_;
    std::set<std::pair<TimePoint, std::uint32_t>> by_deadline_;
};

} // namespace busbar::client::detail

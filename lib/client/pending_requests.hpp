#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include <busbar/core/detail/guarded.hpp>

#include "deadline_heap.hpp"

namespace busbar::client::detail {

/// Requests under way on one connection, each with its own deadline.
class PendingRequests {
public:
    struct Pending {
        std::uint32_t id{0};
        std::uint64_t context{0};
    };

    /// `context` is returned with the request; `handle` is the requestHandle of its header.
    void add(std::uint32_t id, TimePoint deadline, std::uint64_t context, std::uint32_t handle = 0)
    {
        requests_[id] = {deadline, context, handle};
        busbar::detail::Undo undo{[&] { requests_.erase(id); }};
        deadlines_.add(deadline, id);
        undo.keep();
    }
    /// Returns 0 if there is none with this id.
    [[nodiscard]] std::uint32_t handle_of(std::uint32_t id) const
    {
        const auto found = requests_.find(id);
        return found == requests_.end() ? 0 : found->second.handle;
    }
    /// Returns its context; nothing if there is none with this id.
    std::optional<std::uint64_t> remove(std::uint32_t id)
    {
        const auto found = requests_.find(id);
        if (found == requests_.end()) {
            return std::nullopt;
        }
        const std::uint64_t context = found->second.context;
        requests_.erase(found);
        prune();
        return context;
    }
    /// Removes a request whose deadline has come, the earliest first.
    [[nodiscard]] std::optional<Pending> take_expired(TimePoint now)
    {
        if (requests_.empty() || next_deadline() > now) {
            return std::nullopt;
        }
        return take_first();
    }
    /// Removes all requests, in the order of their deadlines.
    [[nodiscard]] std::vector<Pending> take_all()
    {
        std::vector<Pending> all;
        all.reserve(requests_.size());
        while (!requests_.empty()) {
            all.push_back(take_first());
        }
        return all;
    }
    [[nodiscard]] TimePoint next_deadline() const { return deadlines_.next_deadline(); }

private:
    struct Request {
        TimePoint deadline{};
        std::uint64_t context{0};
        std::uint32_t handle{0};
    };

    [[nodiscard]] Pending take_first()
    {
        const std::uint32_t id = deadlines_.first();
        return {id, remove(id).value_or(0)};
    }
    void prune()
    {
        deadlines_.prune(requests_.size(), [this](TimePoint deadline, std::uint32_t id) {
            const auto found = requests_.find(id);
            return found != requests_.end() && found->second.deadline == deadline;
        });
    }

    std::unordered_map<std::uint32_t, Request> requests_;
    DeadlineHeap<std::uint32_t> deadlines_;
};

} // namespace busbar::client::detail

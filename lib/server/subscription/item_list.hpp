#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "monitored_item.hpp"

namespace busbar::server::detail {

/// The items of a Subscription by their ids, which it assigns. A removed item leaves a hole; holes
/// are removed when they are the half, so that removing an item is cheap in any order. Compiled
/// with exceptions, most of the memory of many items is freed when few are left.
class ItemList {
public:
    /// The next id is `last_id` + 1.
    explicit ItemList(std::uint32_t last_id = 0) : last_id_{last_id} {}

    [[nodiscard]] std::size_t size() const { return entries_.size() - holes_; }
    /// Returns null if there is none.
    [[nodiscard]] MonitoredItem* find(std::uint32_t id) const;
    MonitoredItem& add(std::unique_ptr<MonitoredItem> item);
    /// Returns false if there is no such item. Removing items needs no memory.
    [[nodiscard]] bool remove(std::uint32_t id) noexcept;
    /// Removes the one with the highest id; there must be one.
    void remove_last() noexcept;
    /// Calls `function` with each, by ascending ids. It must not add or remove any.
    template <typename Function>
    void for_each(Function function) const
    {
        for (const Entry& entry : entries_) {
            if (entry.item != nullptr) {
                function(*entry.item);
            }
        }
    }
    /// Calls `function` likewise with at most `most` items whose ids are not less than `next_id`,
    /// which it sets to the id after each. Returns their number; fewer than `most` are the last.
    template <typename Function>
    std::size_t for_some(std::uint64_t& next_id, std::size_t most, Function function) const
    {
        std::size_t count = 0;
        std::size_t i =
            next_id > UINT32_MAX ? entries_.size() : place(static_cast<std::uint32_t>(next_id));
        for (; i < entries_.size() && count < most; ++i) {
            if (entries_[i].item != nullptr) {
                function(*entries_[i].item);
                ++count;
            }
            next_id = std::uint64_t{entries_[i].id} + 1;
        }
        return count;
    }

private:
    struct Entry {
        std::uint32_t id;
        /// Null in a hole.
        std::unique_ptr<MonitoredItem> item;
    };

    /// Returns the index of the first entry whose id is not less.
    [[nodiscard]] std::size_t place(std::uint32_t id) const;
    void close_up() noexcept;

    /// In ascending order of ids; the last entry is not a hole.
    std::vector<Entry> entries_;
    std::size_t holes_{0};
    std::uint32_t last_id_;
};

} // namespace busbar::server::detail

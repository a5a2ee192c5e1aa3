#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include <busbar/core/clock.hpp>

namespace busbar::server::detail {

/// Counts the items with each sampling interval, for the diagnostics (Part 5, 12.8). Counts nothing
/// if clients may have any interval.
class SamplingIntervals {
public:
    struct Items {
        std::size_t enabled{0};
        std::size_t disabled{0};
        /// The maximum at the same time.
        std::size_t most{0};
    };
    /// The interval and state with which an item is counted.
    struct Use {
        bool is_disabled{false};
        Duration interval{0};
    };

    /// `is_fixed`: only a few intervals exist.
    explicit SamplingIntervals(bool is_fixed) : is_fixed_{is_fixed} {}

    /// Counts an item at `to` and not at `from` any more; either may be empty. Needs memory only
    /// for a new interval, and without it the counts do not change.
    void change(const std::optional<Use>& from, const std::optional<Use>& to)
    {
        if (!is_fixed_) {
            return;
        }
        std::size_t* const more = to ? &place(*to) : nullptr; // first, as it may fail
        if (from) {
            --place(*from);
        }
        if (more != nullptr) {
            ++*more;
            Items& items = items_[to->interval];
            items.most = std::max(items.most, items.enabled + items.disabled);
        }
    }
    [[nodiscard]] const std::map<Duration, Items>& all() const { return items_; }

private:
    [[nodiscard]] std::size_t& place(const Use& use)
    {
        Items& items = items_[use.interval];
        return use.is_disabled ? items.disabled : items.enabled;
    }

    bool is_fixed_;
    std::map<Duration, Items> items_;
};

} // namespace busbar::server::detail

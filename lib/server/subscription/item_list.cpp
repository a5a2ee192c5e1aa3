#include "item_list.hpp"

#include <algorithm>
#include <utility>

namespace busbar::server::detail {

namespace {

/// Size of a list whose memory is not worth returning.
constexpr std::size_t small_list = 64;

} // namespace

std::size_t ItemList::place(std::uint32_t id) const
{
    const auto found =
        std::lower_bound(entries_.begin(), entries_.end(), id,
                         [](const Entry& entry, std::uint32_t other) { return entry.id < other; });
    return static_cast<std::size_t>(found - entries_.begin());
}

MonitoredItem* ItemList::find(std::uint32_t id) const
{
    const std::size_t at = place(id);
    return at < entries_.size() && entries_[at].id == id ? entries_[at].item.get() : nullptr;
}

MonitoredItem& ItemList::add(std::unique_ptr<MonitoredItem> item)
{
    do {
        ++last_id_;
    } while (last_id_ == 0 || find(last_id_) != nullptr);
    // The end, unless ids have started again.
    const std::size_t at = place(last_id_);
    if (at == entries_.size() || entries_[at].id != last_id_) {
        entries_.insert(entries_.begin() + static_cast<std::ptrdiff_t>(at),
                        Entry{last_id_, nullptr});
        ++holes_;
    }
    item->id_ = last_id_;
    entries_[at].item = std::move(item);
    --holes_;
    return *entries_[at].item;
}

bool ItemList::remove(std::uint32_t id) noexcept
{
    const std::size_t at = place(id);
    if (at == entries_.size() || entries_[at].id != id || entries_[at].item == nullptr) {
        return false;
    }
    entries_[at].item.reset();
    ++holes_;
    close_up();
    return true;
}

void ItemList::remove_last() noexcept
{
    entries_.pop_back();
    close_up();
}

void ItemList::close_up() noexcept
{
    while (!entries_.empty() && entries_.back().item == nullptr) {
        entries_.pop_back();
        --holes_;
    }
    if (holes_ > entries_.size() / 2) {
        std::erase_if(entries_, [](const Entry& entry) { return entry.item == nullptr; });
        holes_ = 0;
    }
    if (entries_.empty()) {
        entries_ = std::vector<Entry>{}; // which gives the memory back
    } else if (entries_.capacity() / 4 > entries_.size() + small_list) {
        entries_.shrink_to_fit(); // or leaves it as it is: no memory, or no exceptions
    }
}

} // namespace busbar::server::detail

#pragma once

#include "core/fetch.hpp"
#include "monitored_item.hpp"

namespace busbar::server::detail {

/// Items with Notifications to report, in the order in which they got the first of them or had
/// their last turn. The links are in the items: nothing is allocated.
class ReadyList {
public:
    ReadyList() = default;
    ReadyList(const ReadyList&) = delete;
    ReadyList& operator=(const ReadyList&) = delete;

    [[nodiscard]] bool empty() const { return first_ == nullptr; }
    [[nodiscard]] MonitoredItem& front() const { return *first_; }
    /// Adds the item, or leaves it in place if it is in the list.
    void add(MonitoredItem& item)
    {
        if (item.is_ready_) {
            return;
        }
        item.is_ready_ = true;
        item.previous_ = last_;
        (last_ != nullptr ? last_->next_ : first_) = &item;
        last_ = &item;
    }
    /// Removes the item, if it is in the list.
    void remove(MonitoredItem& item)
    {
        if (!item.is_ready_) {
            return;
        }
        item.is_ready_ = false;
        (item.previous_ != nullptr ? item.previous_->next_ : first_) = item.next_;
        (item.next_ != nullptr ? item.next_->previous_ : last_) = item.previous_;
        item.previous_ = item.next_ = nullptr;
    }
    /// Writes the first item's oldest Notification, of at most `most` bytes, and removes it;
    /// returns the item.
    MonitoredItem& take_notification(binary::Writer& writer, std::size_t most)
    {
        MonitoredItem& item = *first_;
        fetch_after(item);
        item.take_notification(writer, most);
        if (item.mode() != MonitoringMode::Reporting) {
            --item.released_;
        }
        if (item.reportable() == 0) {
            remove(item);
        }
        return item;
    }
    /// A message is full: an item with more, perhaps endlessly, waits until the others had a turn.
    void end_turn(MonitoredItem& item)
    {
        if (item.is_ready_) {
            remove(item);
            add(item);
        }
    }

private:
    /// Bytes of an item of any kind: they are prefetched while earlier items write.
    static constexpr std::size_t most_item_size = 256;

    static void fetch_after(const MonitoredItem& item)
    {
        const MonitoredItem* const next = item.next_;
        if (next == nullptr) {
            return;
        }
        next->fetch_notification();
        if (next->next_ != nullptr) {
            busbar::detail::fetch(next->next_, most_item_size);
        }
    }

    MonitoredItem* first_{nullptr};
    MonitoredItem* last_{nullptr};
};

} // namespace busbar::server::detail

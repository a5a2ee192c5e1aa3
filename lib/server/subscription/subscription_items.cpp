#include <algorithm>

#include <busbar/core/attribute_id.hpp>

#include "subscription.hpp"
#include "subscription_table.hpp"
#include "value_item.hpp"

namespace busbar::server::detail {

void Subscription::user_changed(TimePoint now)
{
    for (const auto& [id, item] : items_) {
        item->user_changed(context(now));
    }
}

/// Those of a Subscription that has ended are the server's alone.
void Subscription::count_items(std::ptrdiff_t more) noexcept
{
    all_.count_items(more);
    if (share_ != nullptr) {
        share_->items += static_cast<std::size_t>(more);
    }
}

MonitoredItem* Subscription::find_item(std::uint32_t id) const
{
    const auto found = items_.find(id);
    return found == items_.end() ? nullptr : found->second.get();
}

MonitoredItem& Subscription::add_item(std::unique_ptr<MonitoredItem> item)
{
    do {
        ++last_item_id_;
    } while (last_item_id_ == 0 || items_.contains(last_item_id_));
    item->id_ = last_item_id_;
    MonitoredItem& added = *items_.emplace(last_item_id_, std::move(item)).first->second;
    count_items(1);
    return added;
}

bool Subscription::remove_item(std::uint32_t id) noexcept
{
    if (items_.erase(id) == 0) {
        return false;
    }
    count_items(-1);
    return true;
}

std::size_t Subscription::remove_items(std::size_t most) noexcept
{
    const std::size_t count = std::min(most, items_.size());
    for (std::size_t i = 0; i < count; ++i) { // to its end: no destructor throws
        items_.erase(items_.begin());
    }
    count_items(-static_cast<std::ptrdiff_t>(count));
    return count;
}

std::vector<std::uint32_t> Subscription::item_ids() const
{
    std::vector<std::uint32_t> ids;
    ids.reserve(items_.size());
    for (const auto& [id, item] : items_) {
        ids.push_back(id);
    }
    std::sort(ids.begin(), ids.end());
    return ids;
}

void Subscription::resend_data(TimePoint now)
{
    for (const std::uint32_t id : item_ids()) {
        MonitoredItem& item = *find_item(id);
        if (item.mode() == MonitoringMode::Reporting) {
            item.resend(context(now));
        }
    }
}

void Subscription::announce_change(const std::unordered_set<NodeId>& variables,
                                   std::uint32_t status_bits)
{
    constexpr auto value_attribute = static_cast<std::uint32_t>(AttributeId::Value);
    for (const auto& [id, item] : items_) {
        if (item->kind() != MonitoredItem::Kind::Data) {
            continue;
        }
        auto& data = static_cast<ValueItem&>(*item);
        if (data.target().attribute_id == value_attribute && variables.contains(data.node_id())) {
            data.announce_change(status_bits);
        }
    }
}

} // namespace busbar::server::detail

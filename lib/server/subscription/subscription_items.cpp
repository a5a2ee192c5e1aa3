#include <algorithm>
#include <string>
#include <utility>

#include <busbar/core/attribute_id.hpp>
#include <busbar/core/detail/guarded.hpp>

#include "subscription.hpp"
#include "subscription_table.hpp"
#include "value_item.hpp"

namespace busbar::server::detail {

void Subscription::note_user_change() noexcept
{
    review_ = {true, true, review_.resends, 0};
    all_.reviews().add(*this);
}

void Subscription::note_resend() noexcept
{
    review_ = {true, review_.has_other_user, true, 0};
    all_.reviews().add(*this);
}

void Subscription::review(TimePoint now, std::size_t& room)
{
    if (!review_.is_pending) {
        return;
    }
    const std::size_t most = room;
    const std::size_t count = items_.for_some(review_.next_id, most, [&](MonitoredItem& item) {
        --room; // also for one that throws
        if (review_.has_other_user) {
            item.user_changed(context(now));
        }
        if (review_.resends && item.mode() == MonitoringMode::Reporting) {
            item.resend(context(now));
        }
    });
    if (count < most) {
        review_ = {};
    }
}

/// Items of an ended Subscription count only for the server.
void Subscription::count_items(std::ptrdiff_t more) noexcept
{
    all_.count_items(more);
    if (share_ != nullptr) {
        share_->items += static_cast<std::size_t>(more);
    }
}

MonitoredItem& Subscription::add_item(std::unique_ptr<MonitoredItem> item)
{
    MonitoredItem& added = items_.add(std::move(item));
    count_items(1);
    return added;
}

bool Subscription::remove_item(std::uint32_t id) noexcept
{
    if (!items_.remove(id)) {
        return false;
    }
    count_items(-1);
    return true;
}

std::size_t Subscription::remove_items(std::size_t most) noexcept
{
    const std::size_t count = std::min(most, items_.size());
    for (std::size_t i = 0; i < count; ++i) { // always completes: no destructor throws
        items_.remove_last();
    }
    count_items(-static_cast<std::ptrdiff_t>(count));
    return count;
}

std::vector<std::uint32_t> Subscription::item_ids() const
{
    std::vector<std::uint32_t> ids;
    ids.reserve(items_.size());
    items_.for_each([&](const MonitoredItem& item) { ids.push_back(item.id()); });
    return ids;
}

bool Subscription::announce_change(const std::unordered_set<NodeId>& variables,
                                   std::uint32_t status_bits)
{
    constexpr auto value_attribute = static_cast<std::uint32_t>(AttributeId::Value);
    bool is_whole = true;
    items_.for_each([&](MonitoredItem& item) {
        if (item.kind() != MonitoredItem::Kind::Data) {
            return;
        }
        auto& data = static_cast<ValueItem&>(item);
        if (data.target().attribute_id == value_attribute && variables.contains(data.node_id())) {
            is_whole &=
                busbar::detail::caught([&] { data.announce_change(status_bits); }).is_good();
        }
    });
    return is_whole;
}

} // namespace busbar::server::detail

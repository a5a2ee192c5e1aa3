#pragma once

#include <utility>
#include <vector>

#include <busbar/client/subscriptions.hpp>

namespace busbar::test {

using client::ItemHandle;
using client::SubscriptionHandle;
using client::Subscriptions;

/// Keeps what handlers were told.
struct Heard {
    [[nodiscard]] client::SubscriptionHandlers handlers()
    {
        client::SubscriptionHandlers all;
        all.on_data = [this](std::span<const client::DataChange> changes) {
            data.insert(data.end(), changes.begin(), changes.end());
        };
        all.on_events = [this](std::span<const client::EventArrived> arrived) {
            events.insert(events.end(), arrived.begin(), arrived.end());
        };
        all.on_item = [this](ItemHandle item, const client::ItemStatus& status) {
            items.emplace_back(item, status);
        };
        all.on_gap = [this](const client::Gap& gap) { gaps.push_back(gap); };
        all.on_status = [this](StatusCode status, client::DeliveryMode mode,
                               const CreateSubscriptionResponse&) {
            statuses.emplace_back(status, mode);
        };
        return all;
    }
    /// The Int32 values that came since the last call.
    [[nodiscard]] std::vector<std::int32_t> take_values()
    {
        std::vector<std::int32_t> values;
        for (const client::DataChange& change : std::exchange(data, {})) {
            values.push_back(change.value.value.value_or<std::int32_t>(-1));
        }
        return values;
    }

    std::vector<client::DataChange> data;
    std::vector<client::EventArrived> events;
    std::vector<std::pair<ItemHandle, client::ItemStatus>> items;
    std::vector<client::Gap> gaps;
    std::vector<std::pair<StatusCode, client::DeliveryMode>> statuses;
};

} // namespace busbar::test

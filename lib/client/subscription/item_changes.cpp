#include <algorithm>

#include "item_changes.hpp"

namespace busbar::client::detail {

namespace {

/// Returns why `response` lacks a result for each of `count` items; Good if it is complete.
template <typename Response>
StatusCode failure(const Result<Response>& response, std::size_t count)
{
    if (!response) {
        return response.error();
    }
    return response->results.size() == count ? StatusCode{} : status::Bad_UnexpectedError;
}

} // namespace

ItemChanges::ItemChanges(ItemTable& items, ItemRequests& requests)
    : items_{items}, requests_{requests}
{
}

bool ItemChanges::send_one(WatchedSubscription& subscription)
{
    return modify(subscription) || set_modes(subscription) || link(subscription);
}

bool ItemChanges::modify(WatchedSubscription& subscription)
{
    for (std::size_t i = 0; i < ItemWork::timestamps_count; ++i) {
        auto& queue = subscription.work.to_modify[i];
        ModifyMonitoredItemsRequest request;
        request.subscription_id = subscription.server_id;
        request.timestamps_to_return = static_cast<TimestampsToReturn>(i);
        std::vector<ItemHandle> batch;
        for (; !queue.empty() && batch.size() < requests_.batch_limit(); queue.pop_front()) {
            Item* item = items_.find(queue.front());
            if (item != nullptr && item->is_created && item->is_modified &&
                static_cast<std::size_t>(item->parameters->timestamps) == i) {
                item->is_modified = false;
                batch.push_back(queue.front());
                request.items_to_modify.push_back(
                    {item->server_id, item->parameters->for_server(queue.front())});
            }
        }
        if (!batch.empty()) {
            send_modification(subscription, std::move(request), batch);
            return true;
        }
    }
    return false;
}

void ItemChanges::send_modification(WatchedSubscription& subscription,
                                    ModifyMonitoredItemsRequest request,
                                    const std::vector<ItemHandle>& batch)
{
    const auto redo = [this, batch](WatchedSubscription& changed) {
        for (const ItemHandle handle : batch) {
            if (Item* item = items_.find(handle)) {
                item->is_modified = true;
                const auto timestamps = static_cast<std::size_t>(item->parameters->timestamps);
                changed.work.to_modify[timestamps].push_back(handle);
            }
        }
    };
    requests_.change<ModifyMonitoredItemsResponse>(
        subscription, std::move(request), batch.size(), redo,
        [this, batch](WatchedSubscription& changed, const auto& response) {
            ItemStatuses statuses;
            for (std::size_t i = 0; i < batch.size(); ++i) {
                if (const StatusCode bad = failure(response, batch.size()); bad.is_bad()) {
                    statuses.push_back({batch[i], {bad, 0, 0, {}}});
                    continue;
                }
                const MonitoredItemModifyResult& result = response->results[i];
                statuses.push_back({batch[i],
                                    {result.status_code, result.revised_sampling_interval,
                                     result.revised_queue_size, result.filter_result}});
            }
            changed.report_items(items_, statuses);
        });
}

bool ItemChanges::set_modes(WatchedSubscription& subscription)
{
    for (std::size_t i = 0; i < subscription.work.to_set_mode.size(); ++i) {
        auto& queue = subscription.work.to_set_mode[i];
        SetMonitoringModeRequest request;
        request.subscription_id = subscription.server_id;
        request.monitoring_mode = static_cast<MonitoringMode>(i);
        std::vector<ItemHandle> batch;
        for (; !queue.empty() && batch.size() < requests_.batch_limit(); queue.pop_front()) {
            Item* item = items_.find(queue.front());
            if (item != nullptr && item->is_created && item->is_mode_changed &&
                item->mode == request.monitoring_mode) {
                item->is_mode_changed = false;
                batch.push_back(queue.front());
                request.monitored_item_ids.push_back(item->server_id);
            }
        }
        if (!batch.empty()) {
            send_modes(subscription, std::move(request), batch);
            return true;
        }
    }
    return false;
}

void ItemChanges::send_modes(WatchedSubscription& subscription, SetMonitoringModeRequest request,
                             const std::vector<ItemHandle>& batch)
{
    const auto redo = [this, batch](WatchedSubscription& changed) {
        for (const ItemHandle handle : batch) {
            if (Item* item = items_.find(handle)) {
                item->is_mode_changed = true;
                changed.work.to_set_mode[static_cast<std::size_t>(item->mode)].push_back(handle);
            }
        }
    };
    requests_.change<SetMonitoringModeResponse>(
        subscription, std::move(request), batch.size(), redo,
        [this, batch](WatchedSubscription& changed, const auto& response) {
            ItemStatuses refused;
            const StatusCode bad = failure(response, batch.size());
            for (std::size_t i = 0; i < batch.size(); ++i) {
                const StatusCode status = bad.is_bad() ? bad : response->results[i];
                if (status.is_bad()) {
                    refused.push_back({batch[i], {status, 0, 0, {}}});
                }
            }
            changed.report_items(items_, refused);
        });
}

bool ItemChanges::remove(WatchedSubscription& subscription)
{
    auto& queue = subscription.work.to_delete;
    if (queue.empty()) {
        return false;
    }
    const std::size_t count = std::min(queue.size(), requests_.batch_limit());
    const auto end = queue.begin() + static_cast<std::ptrdiff_t>(count);
    const std::vector<std::uint32_t> ids{queue.begin(), end};
    queue.erase(queue.begin(), end);
    DeleteMonitoredItemsRequest request;
    request.subscription_id = subscription.server_id;
    request.monitored_item_ids = Array<std::uint32_t>{ids};
    const auto redo = [ids](WatchedSubscription& changed) {
        changed.work.to_delete.insert(changed.work.to_delete.end(), ids.begin(), ids.end());
    };
    // An item that does not exist any more is as good as deleted.
    requests_.change<DeleteMonitoredItemsResponse>(subscription, std::move(request), count, redo,
                                                   [](WatchedSubscription&, const auto&) {});
    return true;
}

} // namespace busbar::client::detail

#include <algorithm>

#include "item_changes.hpp"

namespace busbar::client::detail {

namespace {

/// Returns the next handles of `queue` for which `is_due` holds, at most `limit`, each once.
template <typename IsDue>
std::vector<ItemHandle> take_batch(std::deque<ItemHandle>& queue, std::size_t limit, IsDue is_due)
{
    std::vector<ItemHandle> batch;
    batch.reserve(std::min(queue.size(), limit));
    bool is_rising = true; // as of items that were added together, of which none is there twice
    while (!queue.empty() && batch.size() < limit) {
        const ItemHandle next = queue.front();
        if (is_due(next)) {
            is_rising = is_rising && (batch.empty() || batch.back() < next);
            batch.push_back(next);
        }
        queue.pop_front();
    }
    if (!is_rising) {
        std::vector<ItemHandle> sorted = batch;
        std::sort(sorted.begin(), sorted.end());
        if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
            sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
            batch = std::move(sorted);
        }
    }
    return batch;
}

} // namespace

ItemCreation::ItemCreation(SessionRequests& requests, WatchList& subscriptions, ItemTable& items,
                           SubscriptionEnds& ends, ItemRequests& changes, ItemPolling& polling)
    : requests_{requests}, subscriptions_{subscriptions}, items_{items}, ends_{ends},
      changes_{changes}, polling_{polling}
{
}

bool ItemCreation::create(WatchedSubscription& subscription)
{
    for (std::size_t i = 0; i < ItemWork::timestamps_count; ++i) {
        auto batch = take_batch(
            subscription.work.to_create[i], changes_.batch_limit(), [&](ItemHandle handle) {
                const Item* item = items_.find(handle);
                return item != nullptr && !item->is_created &&
                       static_cast<std::size_t>(item->parameters->timestamps) == i;
            });
        if (!batch.empty()) {
            resolve_items(subscription, std::move(batch));
            return true;
        }
    }
    return false;
}

void ItemCreation::resolve_items(WatchedSubscription& subscription, std::vector<ItemHandle> items)
{
    bool has_paths = false;
    for (const ItemHandle handle : items) {
        Item& item = *items_.find(handle);
        item.is_modified = item.is_mode_changed = false;
        has_paths = has_paths || item.node.is_path();
    }
    subscription.is_busy = true;
    subscription.under_way = std::move(items);
    if (!has_paths) {
        std::vector<Result<NodeId>> nodes;
        nodes.reserve(subscription.under_way.size());
        for (const ItemHandle handle : subscription.under_way) {
            nodes.push_back(items_.find(handle)->node.node_id(requests_.server()));
        }
        return items_resolved(subscription.handle, std::move(nodes));
    }
    std::vector<NodeAddress> addresses;
    addresses.reserve(subscription.under_way.size());
    for (const ItemHandle handle : subscription.under_way) {
        addresses.push_back(items_.find(handle)->node);
    }
    changes_.resolve_nodes(
        subscription, std::move(addresses),
        [this, handle = subscription.handle](const auto& nodes) { items_resolved(handle, nodes); });
}

void ItemCreation::items_resolved(SubscriptionHandle handle, std::vector<Result<NodeId>> nodes)
{
    WatchedSubscription& subscription = *subscriptions_.find(handle);
    const auto items = std::exchange(subscription.under_way, {});
    Array<MonitoredItemCreateRequest> requests;
    requests.reserve(items.size());
    ItemStatuses statuses;
    auto timestamps = TimestampsToReturn::Both;
    bool is_late = false;
    for (std::size_t i = 0; i < items.size() && i < nodes.size(); ++i) {
        const Item* item = items_.find(items[i]);
        if (item == nullptr) {
            continue;
        }
        if (!nodes[i] && is_uncertain(nodes[i].error())) {
            subscription.queue_creation(items_, items[i]); // its path was not resolved
            is_late = true;
        } else if (!nodes[i]) {
            statuses.push_back({items[i], {nodes[i].error(), 0, 0, {}}});
        } else if (subscription.phase == Phase::Polling) {
            statuses.push_back({items[i], polling_.add(subscription, items[i], *nodes[i])});
        } else {
            timestamps = item->parameters->timestamps;
            MonitoredItemCreateRequest& request = requests.emplace_back();
            request.item_to_monitor.node_id = *std::move(nodes[i]);
            request.item_to_monitor.attribute_id =
                static_cast<std::uint32_t>(item->parameters->attribute);
            request.item_to_monitor.index_range = item->parameters->index_range;
            request.monitoring_mode = item->mode;
            request.requested_parameters = item->parameters->for_server(items[i]);
            subscription.under_way.push_back(items[i]);
        }
    }
    if (is_late) {
        subscription.try_later(requests_.now());
    }
    subscription.is_busy = !requests.empty();
    if (requests.empty()) {
        requests_.call_for_work();
    } else {
        send_creation(subscription, std::move(requests), timestamps);
    }
    subscription.report_items(items_, statuses);
}

void ItemCreation::send_creation(WatchedSubscription& subscription,
                                 Array<MonitoredItemCreateRequest> requests,
                                 TimestampsToReturn timestamps)
{
    CreateMonitoredItemsRequest request;
    request.subscription_id = subscription.server_id;
    request.timestamps_to_return = timestamps;
    request.items_to_create = std::move(requests);
    subscription.is_uncertain = true;
    requests_.send<CreateMonitoredItemsResponse>(
        std::move(request), [this, handle = subscription.handle,
                             incarnation = subscription.incarnation](const auto& response) {
            if (WatchedSubscription* found = subscriptions_.find(handle, incarnation)) {
                items_created(*found, response);
            }
        });
}

void ItemCreation::items_created(WatchedSubscription& subscription,
                                 const Result<CreateMonitoredItemsResponse>& response)
{
    subscription.is_busy = false;
    if (!response || response->results.size() != subscription.under_way.size()) {
        item_creation_failed(subscription,
                             response ? StatusCode{status::Bad_UnexpectedError} : response.error());
        return;
    }
    subscription.is_uncertain = false;
    subscription.failures = 0;
    const auto items = std::exchange(subscription.under_way, {});
    ItemStatuses statuses;
    statuses.reserve(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        statuses.push_back({items[i], item_created(subscription, items[i], response->results[i])});
    }
    subscription.report_items(items_, statuses);
}

ItemStatus ItemCreation::item_created(WatchedSubscription& subscription, ItemHandle handle,
                                      const MonitoredItemCreateResult& result)
{
    Item* item = items_.find(handle);
    ItemWork& work = subscription.work;
    if (!result.status_code.is_bad() && item == nullptr) {
        work.to_delete.push_back(result.monitored_item_id); // removed in the meantime
    } else if (!result.status_code.is_bad()) {
        item->is_created = true;
        item->server_id = result.monitored_item_id;
        item->told_after = subscription.refresh.losses; // its first value has not arrived yet
        if (item->is_modified) {
            work.to_modify[static_cast<std::size_t>(item->parameters->timestamps)].push_back(
                handle);
        }
        if (item->is_mode_changed) {
            work.to_set_mode[static_cast<std::size_t>(item->mode)].push_back(handle);
        }
    }
    return {result.status_code, result.revised_sampling_interval, result.revised_queue_size,
            result.filter_result};
}

void ItemCreation::item_creation_failed(WatchedSubscription& subscription, StatusCode status)
{
    if (is_uncertain(status) || status == status::Bad_SubscriptionIdInvalid) {
        ends_.lost(subscription, status, status != status::Bad_SubscriptionIdInvalid);
        return;
    }
    subscription.is_uncertain = false;
    const auto items = std::exchange(subscription.under_way, {});
    const bool is_smaller = changes_.shrink(status, items.size());
    if (!is_smaller && subscription.failures >= ItemRequests::max_tries) {
        ItemStatuses statuses;
        for (const ItemHandle handle : items) {
            statuses.push_back({handle, {status, 0, 0, {}}});
        }
        subscription.failures = 0;
        subscription.report_items(items_, statuses);
        return;
    }
    if (!is_smaller) {
        subscription.try_later(requests_.now());
    }
    for (const ItemHandle handle : items) {
        subscription.queue_creation(items_, handle);
    }
}

} // namespace busbar::client::detail

#include <algorithm>

#include "engine.hpp"

namespace busbar::client::detail {

namespace {

constexpr std::uint32_t max_creations = 3;

/// The next handles of `queue` for which `is_due` holds, `limit` at most.
template <typename IsDue>
std::vector<ItemHandle> take_batch(std::deque<ItemHandle>& queue, std::size_t limit, IsDue is_due)
{
    std::vector<ItemHandle> batch;
    while (!queue.empty() && batch.size() < limit) {
        if (is_due(queue.front())) {
            batch.push_back(queue.front());
        }
        queue.pop_front();
    }
    return batch;
}

/// The request may have been carried out though nobody knows its results.
bool is_uncertain(StatusCode status)
{
    return status == status::Bad_Timeout || status == status::Bad_ConnectionClosed ||
           status == status::Bad_SecureChannelClosed || status == status::Bad_DecodingError ||
           status == status::Bad_UnexpectedError || status == status::Bad_RequestInterrupted;
}

bool is_too_large(StatusCode status)
{
    return status == status::Bad_TooManyOperations || status == status::Bad_RequestTooLarge ||
           status == status::Bad_ResponseTooLarge || status == status::Bad_EncodingLimitsExceeded;
}

} // namespace

std::size_t SubscriptionEngine::batch_limit() const
{
    const std::size_t limit = requester_.server().operation_limits.max_monitored_items_per_call;
    return std::min(max_batch_, limit == 0 ? default_batch : std::min(limit, default_batch));
}

void SubscriptionEngine::queue_creation(WatchedSubscription& subscription, ItemHandle handle)
{
    if (const Item* item = items_.find(handle)) {
        const auto timestamps = static_cast<std::size_t>(item->parameters->timestamps);
        subscription.work.to_create[timestamps].push_back(handle);
    }
}

void SubscriptionEngine::queue_all_items(WatchedSubscription& subscription)
{
    subscription.work.clear();
    for (const ItemHandle handle : subscription.items) {
        if (Item* item = items_.find(handle)) {
            item->is_created = false;
            item->server_id = 0;
            queue_creation(subscription, handle);
        }
    }
    for (auto& [trigger, links] : subscription.links) {
        links.made.clear();
        subscription.work.to_link.push_back(trigger);
    }
}

bool SubscriptionEngine::create_items(WatchedSubscription& subscription)
{
    for (std::size_t i = 0; i < ItemWork::timestamps_count; ++i) {
        auto batch =
            take_batch(subscription.work.to_create[i], batch_limit(), [&](ItemHandle handle) {
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

void SubscriptionEngine::resolve_items(WatchedSubscription& subscription,
                                       std::vector<ItemHandle> items)
{
    std::vector<NodeAddress> addresses;
    addresses.reserve(items.size());
    for (const ItemHandle handle : items) {
        Item& item = *items_.find(handle);
        item.is_modified = item.is_mode_changed = false;
        addresses.push_back(item.node);
    }
    subscription.is_busy = true;
    subscription.under_way = std::move(items);
    resolve_nodes(
        subscription, std::move(addresses),
        [this, handle = subscription.handle](const auto& nodes) { items_resolved(handle, nodes); });
}

void SubscriptionEngine::resolve_nodes(const WatchedSubscription& subscription,
                                       std::vector<NodeAddress> addresses,
                                       std::function<void(const std::vector<Result<NodeId>>&)> done)
{
    const bool has_paths =
        std::any_of(addresses.begin(), addresses.end(),
                    [](const NodeAddress& address) { return address.is_path(); });
    if (!has_paths) {
        std::vector<Result<NodeId>> nodes;
        nodes.reserve(addresses.size());
        for (const NodeAddress& address : addresses) {
            nodes.push_back(address.node_id(requester_.server()));
        }
        done(nodes);
        return;
    }
    resolve(requester_, std::move(addresses),
            [guard = guard(subscription), done = std::move(done)](const auto& nodes) {
                if (guard()) {
                    done(nodes);
                }
            });
}

std::function<bool()> SubscriptionEngine::guard(const WatchedSubscription& subscription) const
{
    return [self = std::weak_ptr{self_}, epoch = epoch_, handle = subscription.handle,
            incarnation = subscription.incarnation] {
        const auto engine = self.lock();
        return engine && (*engine)->epoch_ == epoch &&
               (*engine)->find(handle, incarnation) != nullptr;
    };
}

void SubscriptionEngine::items_resolved(SubscriptionHandle handle,
                                        const std::vector<Result<NodeId>>& nodes)
{
    WatchedSubscription& subscription = *find(handle);
    const auto items = std::exchange(subscription.under_way, {});
    Array<MonitoredItemCreateRequest> requests;
    ItemStatuses statuses;
    auto timestamps = TimestampsToReturn::Both;
    for (std::size_t i = 0; i < items.size() && i < nodes.size(); ++i) {
        const Item* item = items_.find(items[i]);
        if (item == nullptr) {
            continue;
        }
        if (!nodes[i] && is_uncertain(nodes[i].error())) {
            queue_creation(subscription, items[i]); // its path was not looked up
            try_later(subscription);
        } else if (!nodes[i]) {
            statuses.push_back({items[i], {nodes[i].error(), 0, 0, {}}});
        } else if (subscription.phase == Phase::Polling) {
            statuses.push_back({items[i], start_polling(subscription, items[i], *nodes[i])});
        } else {
            timestamps = item->parameters->timestamps;
            MonitoredItemCreateRequest& request = requests.emplace_back();
            request.item_to_monitor.node_id = *nodes[i];
            request.item_to_monitor.attribute_id =
                static_cast<std::uint32_t>(item->parameters->attribute);
            request.item_to_monitor.index_range = item->parameters->index_range;
            request.monitoring_mode = item->mode;
            request.requested_parameters = item->parameters->for_server(items[i]);
            subscription.under_way.push_back(items[i]);
        }
    }
    subscription.is_busy = !requests.empty();
    has_work_ = has_work_ || requests.empty();
    if (!requests.empty()) {
        send_creation(subscription, std::move(requests), timestamps);
    }
    report_items(subscription, statuses);
}

void SubscriptionEngine::send_creation(WatchedSubscription& subscription,
                                       Array<MonitoredItemCreateRequest> requests,
                                       TimestampsToReturn timestamps)
{
    CreateMonitoredItemsRequest request;
    request.subscription_id = subscription.server_id;
    request.timestamps_to_return = timestamps;
    request.items_to_create = std::move(requests);
    subscription.is_uncertain = true;
    send<CreateMonitoredItemsResponse>(
        std::move(request), [this, handle = subscription.handle,
                             incarnation = subscription.incarnation](const auto& response) {
            if (WatchedSubscription* found = find(handle, incarnation)) {
                items_created(*found, response);
            }
        });
}

void SubscriptionEngine::items_created(WatchedSubscription& subscription,
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
    report_items(subscription, statuses);
}

ItemStatus SubscriptionEngine::item_created(WatchedSubscription& subscription, ItemHandle handle,
                                            const MonitoredItemCreateResult& result)
{
    Item* item = items_.find(handle);
    ItemWork& work = subscription.work;
    if (!result.status_code.is_bad() && item == nullptr) {
        work.to_delete.push_back(result.monitored_item_id); // removed in the meantime
    } else if (!result.status_code.is_bad()) {
        item->is_created = true;
        item->server_id = result.monitored_item_id;
        item->told_after = subscription.refresh.losses; // its first value is still to come
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

void SubscriptionEngine::item_creation_failed(WatchedSubscription& subscription, StatusCode status)
{
    if (is_uncertain(status) || status == status::Bad_SubscriptionIdInvalid) {
        lost(subscription, status, true);
        return;
    }
    subscription.is_uncertain = false;
    const auto items = std::exchange(subscription.under_way, {});
    if (is_too_large(status) && items.size() > 1) {
        max_batch_ = items.size() / 2;
    } else if (subscription.failures < max_creations) {
        try_later(subscription);
    } else {
        ItemStatuses statuses;
        for (const ItemHandle handle : items) {
            statuses.push_back({handle, {status, 0, 0, {}}});
        }
        subscription.failures = 0;
        report_items(subscription, statuses);
        return;
    }
    for (const ItemHandle handle : items) {
        queue_creation(subscription, handle);
    }
}

bool SubscriptionEngine::change_failed(WatchedSubscription& subscription, StatusCode status,
                                       std::size_t count)
{
    if (status == status::Bad_SubscriptionIdInvalid) {
        lost(subscription, status, false);
        return false;
    }
    if (is_too_large(status) && count > 1) {
        max_batch_ = count / 2;
        return true;
    }
    if (subscription.failures >= max_creations) {
        subscription.failures = 0;
        return false;
    }
    try_later(subscription);
    return true;
}

void SubscriptionEngine::report_items(WatchedSubscription& subscription,
                                      const ItemStatuses& statuses)
{
    const auto handlers = subscription.handlers;
    if (!handlers->on_item) {
        return;
    }
    for (const auto& [item, status] : statuses) {
        if (items_.find(item) != nullptr) {
            handlers->on_item(item, status);
        }
    }
}

} // namespace busbar::client::detail

#include <algorithm>

#include "client/guarded_handler.hpp"
#include "engine.hpp"

namespace busbar::client::detail {

namespace {

// Up to so many removed items are not worth going through the list.
constexpr std::size_t few_items = 64;

StatusCode check(const ItemSettings& settings)
{
    if (settings.timestamps < TimestampsToReturn::Source ||
        settings.timestamps > TimestampsToReturn::Neither) {
        return status::Bad_TimestampsToReturnInvalid;
    }
    if (settings.mode < MonitoringMode::Disabled || settings.mode > MonitoringMode::Reporting) {
        return status::Bad_MonitoringModeInvalid;
    }
    return status::Good;
}

SubscriptionHandlers guarded(SubscriptionHandlers handlers, LogSink* log)
{
    const auto guard = [log](auto& handler, std::string_view name) {
        handler = guarded_handler(log, name, std::move(handler));
    };
    guard(handlers.on_data, "SubscriptionHandlers::on_data");
    guard(handlers.on_events, "SubscriptionHandlers::on_events");
    guard(handlers.on_item, "SubscriptionHandlers::on_item");
    guard(handlers.on_gap, "SubscriptionHandlers::on_gap");
    guard(handlers.on_status, "SubscriptionHandlers::on_status");
    return handlers;
}

void drop_removed(WatchedSubscription& subscription, ItemTable& items)
{
    if (subscription.removed_items < few_items ||
        subscription.removed_items < subscription.items.size() / 2) {
        return;
    }
    std::erase_if(subscription.items, [&](ItemHandle item) { return items.find(item) == nullptr; });
    subscription.removed_items = 0;
}

} // namespace

Result<SubscriptionHandle> SubscriptionEngine::create(const SubscriptionSettings& settings,
                                                      SubscriptionHandlers handlers)
{
    if (subscriptions_.size() >= limits_.max_subscriptions) {
        return fail(status::Bad_TooManySubscriptions);
    }
    const SubscriptionHandle handle = ++last_handle_;
    subscriptions_.try_emplace(handle, handle, settings,
                               guarded(std::move(handlers), requester_.log()), limits_.max_missing);
    has_work_ = true;
    return handle;
}

Result<void> SubscriptionEngine::modify(SubscriptionHandle handle,
                                        const SubscriptionSettings& settings)
{
    WatchedSubscription* subscription = find(handle);
    if (subscription == nullptr) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    subscription->settings = settings;
    subscription->is_modified = true;
    has_work_ = true;
    return {};
}

Result<void> SubscriptionEngine::remove(SubscriptionHandle handle)
{
    WatchedSubscription* subscription = find(handle);
    if (subscription == nullptr) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    for (const ItemHandle item : subscription->items) {
        items_.remove(item);
    }
    if (subscription->server_id != 0) {
        by_server_id_.erase(subscription->server_id);
        forget_acknowledgements(subscription->server_id);
        doom(subscription->server_id);
    }
    subscriptions_.erase(handle);
    has_work_ = true;
    return {};
}

Result<std::vector<ItemHandle>> SubscriptionEngine::add_items(SubscriptionHandle handle,
                                                              std::vector<ItemSettings> items)
{
    WatchedSubscription* subscription = find(handle);
    if (subscription == nullptr) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    if (items.size() > std::min(limits_.max_items, ItemTable::capacity) - items_.size()) {
        return fail(status::Bad_TooManyMonitoredItems);
    }
    for (const ItemSettings& settings : items) {
        if (const StatusCode bad = check(settings); bad.is_bad()) {
            return fail(bad);
        }
    }
    std::vector<ItemHandle> handles;
    handles.reserve(items.size());
    std::shared_ptr<const ItemParameters> parameters;
    for (ItemSettings& settings : items) {
        if (!parameters || !parameters->are_those_of(settings)) {
            parameters = std::make_shared<ItemParameters>(settings);
        }
        Item item;
        item.node = std::move(settings.node);
        item.parameters = parameters;
        item.subscription = handle;
        item.mode = settings.mode;
        handles.push_back(items_.add(std::move(item)));
        subscription->work.to_create[static_cast<std::size_t>(settings.timestamps)].push_back(
            handles.back());
    }
    subscription->items.insert(subscription->items.end(), handles.begin(), handles.end());
    has_work_ = true;
    return handles;
}

Result<void> SubscriptionEngine::modify_items(std::span<const ItemHandle> items,
                                              const ItemSettings& settings)
{
    if (const StatusCode bad = check(settings); bad.is_bad()) {
        return fail(bad);
    }
    if (std::any_of(items.begin(), items.end(),
                    [&](ItemHandle item) { return items_.find(item) == nullptr; })) {
        return fail(status::Bad_MonitoredItemIdInvalid);
    }
    const auto parameters = std::make_shared<ItemParameters>(settings);
    for (const ItemHandle handle : items) {
        Item& item = *items_.find(handle);
        ItemWork& work = find(item.subscription)->work;
        item.is_mode_changed = item.is_mode_changed || item.mode != settings.mode;
        item.mode = settings.mode;
        item.is_modified = item.is_modified || !item.parameters->are_those_of(settings);
        item.parameters = parameters;
        const auto timestamps = static_cast<std::size_t>(settings.timestamps);
        if (find(item.subscription)->phase == Phase::Polling) {
            item.is_created = false; // it finds its place among the others anew
        }
        if (!item.is_created) {
            work.to_create[timestamps].push_back(handle);
            continue;
        }
        if (item.is_modified) {
            work.to_modify[timestamps].push_back(handle);
        }
        if (item.is_mode_changed) {
            work.to_set_mode[static_cast<std::size_t>(settings.mode)].push_back(handle);
        }
    }
    has_work_ = true;
    return {};
}

Result<void> SubscriptionEngine::remove_items(std::span<const ItemHandle> items)
{
    if (std::any_of(items.begin(), items.end(),
                    [&](ItemHandle item) { return items_.find(item) == nullptr; })) {
        return fail(status::Bad_MonitoredItemIdInvalid);
    }
    for (const ItemHandle handle : items) {
        const Item* item = items_.find(handle);
        if (item == nullptr) {
            continue; // it stands there twice
        }
        WatchedSubscription& subscription = *find(item->subscription);
        if (item->is_created && subscription.phase != Phase::Polling) {
            subscription.work.to_delete.push_back(item->server_id);
        }
        subscription.links.erase(handle);
        ++subscription.removed_items;
        items_.remove(handle);
        drop_removed(subscription, items_);
    }
    has_work_ = true;
    return {};
}

Result<void> SubscriptionEngine::set_triggering(ItemHandle trigger, std::vector<ItemHandle> links)
{
    const Item* item = items_.find(trigger);
    const auto is_no_link = [&](ItemHandle link) {
        const Item* linked = items_.find(link);
        return linked == nullptr || linked->subscription != item->subscription;
    };
    // Part 4, 5.13.1.6: an item and what it triggers are in one Subscription.
    if (item == nullptr || std::any_of(links.begin(), links.end(), is_no_link)) {
        return fail(status::Bad_MonitoredItemIdInvalid);
    }
    WatchedSubscription& subscription = *find(item->subscription);
    std::sort(links.begin(), links.end());
    links.erase(std::unique(links.begin(), links.end()), links.end());
    subscription.links[trigger].wished = std::move(links);
    subscription.work.to_link.push_back(trigger);
    has_work_ = true;
    return {};
}

WatchedSubscription* SubscriptionEngine::find(SubscriptionHandle handle)
{
    const auto found = subscriptions_.find(handle);
    return found == subscriptions_.end() ? nullptr : &found->second;
}

WatchedSubscription* SubscriptionEngine::find(SubscriptionHandle handle, std::uint32_t incarnation)
{
    WatchedSubscription* subscription = find(handle);
    return subscription != nullptr && subscription->incarnation == incarnation ? subscription
                                                                               : nullptr;
}

} // namespace busbar::client::detail

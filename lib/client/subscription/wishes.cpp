#include <algorithm>

#include "client/services/handlers.hpp"
#include "engine.hpp"

namespace busbar::client::detail {

namespace {

// With so few removed items it is not worth cleaning the list.
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

Wishes::Wishes(SessionRequests& requests, WatchList& subscriptions, ItemTable& items,
               SubscriptionEnds& ends, const SubscriberLimits& limits)
    : requests_{requests}, subscriptions_{subscriptions}, items_{items}, ends_{ends}, limits_{
                                                                                          limits}
{
}

Result<SubscriptionHandle> Wishes::create(const SubscriptionSettings& settings,
                                          SubscriptionHandlers handlers)
{
    if (subscriptions_.size() >= limits_.max_subscriptions) {
        return fail(status::Bad_TooManySubscriptions);
    }
    const WatchedSubscription& added = subscriptions_.add(
        settings, guarded(std::move(handlers), requests_.requester().log()), limits_.max_missing);
    requests_.call_for_work();
    return added.handle;
}

Result<void> Wishes::modify(SubscriptionHandle handle, const SubscriptionSettings& settings)
{
    WatchedSubscription* subscription = subscriptions_.find(handle);
    if (subscription == nullptr) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    subscription->settings = settings;
    subscription->is_modified = true;
    requests_.call_for_work();
    return {};
}

Result<void> Wishes::remove(SubscriptionHandle handle)
{
    WatchedSubscription* subscription = subscriptions_.find(handle);
    if (subscription == nullptr) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    for (const ItemHandle item : subscription->items) {
        items_.remove(item);
    }
    ends_.remove(*subscription);
    requests_.call_for_work();
    return {};
}

Result<std::vector<ItemHandle>> Wishes::add_items(SubscriptionHandle handle,
                                                  std::vector<ItemSettings> items)
{
    WatchedSubscription* subscription = subscriptions_.find(handle);
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
    busbar::detail::Undo undo{[&] {
        for (const ItemHandle added : handles) {
            items_.remove(added);
        }
    }};
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
    undo.keep();
    requests_.call_for_work();
    return handles;
}

Result<void> Wishes::modify_items(std::span<const ItemHandle> items, const ItemSettings& settings)
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
        ItemWork& work = subscriptions_.find(item.subscription)->work;
        item.is_mode_changed = item.is_mode_changed || item.mode != settings.mode;
        item.mode = settings.mode;
        item.is_modified = item.is_modified || !item.parameters->are_those_of(settings);
        item.parameters = parameters;
        const auto timestamps = static_cast<std::size_t>(settings.timestamps);
        if (subscriptions_.find(item.subscription)->phase == Phase::Polling) {
            item.is_created = false; // it gets a new place among the others
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
    requests_.call_for_work();
    return {};
}

Result<void> Wishes::remove_items(std::span<const ItemHandle> items)
{
    if (std::any_of(items.begin(), items.end(),
                    [&](ItemHandle item) { return items_.find(item) == nullptr; })) {
        return fail(status::Bad_MonitoredItemIdInvalid);
    }
    for (const ItemHandle handle : items) {
        const Item* item = items_.find(handle);
        if (item == nullptr) {
            continue; // it appears twice
        }
        WatchedSubscription& subscription = *subscriptions_.find(item->subscription);
        if (item->is_created && subscription.phase != Phase::Polling) {
            subscription.work.to_delete.push_back(item->server_id);
        }
        subscription.links.erase(handle);
        ++subscription.removed_items;
        items_.remove(handle);
        drop_removed(subscription, items_);
    }
    requests_.call_for_work();
    return {};
}

Result<void> Wishes::set_triggering(ItemHandle trigger, std::vector<ItemHandle> links)
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
    WatchedSubscription& subscription = *subscriptions_.find(item->subscription);
    std::sort(links.begin(), links.end());
    links.erase(std::unique(links.begin(), links.end()), links.end());
    subscription.links[trigger].wished = std::move(links);
    subscription.work.to_link.push_back(trigger);
    requests_.call_for_work();
    return {};
}

} // namespace busbar::client::detail

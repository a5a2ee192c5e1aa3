#include "monitored_item_services.hpp"

#include <busbar/core/attribute_id.hpp>

#include "data_item.hpp"
#include "sampler.hpp"
#include "server/session/session.hpp"
#include "subscription.hpp"
#include "subscription_services.hpp"
#include "subscription_table.hpp"

namespace busbar::server::detail {

namespace {

bool is_known(MonitoringMode mode)
{
    return mode >= MonitoringMode::Disabled && mode <= MonitoringMode::Reporting;
}

bool is_known(TimestampsToReturn timestamps)
{
    return timestamps >= TimestampsToReturn::Source && timestamps <= TimestampsToReturn::Neither;
}

/// The session's Subscription, whose client has shown with this that it is there; else why the
/// request is refused, which has `count` operations.
Result<Subscription*> find_subscription(Subscriptions& all, const ServiceContext& context,
                                        std::uint32_t id, std::size_t count)
{
    Subscription* const subscription = all.find(id, *context.session);
    if (subscription == nullptr) {
        return fail(status::Bad_SubscriptionIdInvalid);
    }
    subscription->reset_lifetime_counter();
    if (const StatusCode bad = check_count(all.needs().limits, count); bad.is_bad()) {
        return fail(bad);
    }
    return subscription;
}

bool is_full(const ItemContext& context)
{
    const SubscriptionLimits& limits = context.all.needs().limits.subscriptions;
    return context.subscription.item_count() >= limits.max_items_per_subscription ||
           context.all.item_count() >= limits.max_items;
}

std::unique_ptr<MonitoredItem> make_item(const ItemContext& context,
                                         const MonitoredItemCreateRequest& request,
                                         TimestampsToReturn timestamps, ItemRevision& revision)
{
    if (!is_known(request.monitoring_mode)) {
        revision.status = status::Bad_MonitoringModeInvalid;
        return nullptr;
    }
    if (is_full(context)) {
        revision.status = status::Bad_TooManyMonitoredItems;
        return nullptr;
    }
    const auto attribute = static_cast<AttributeId>(request.item_to_monitor.attribute_id);
    if (attribute == AttributeId::EventNotifier) {
        return context.all.needs().event_items.make(context, request, revision);
    }
    return DataItem::make(context, request, timestamps, revision);
}

MonitoredItemCreateResult create_one(const ItemContext& context,
                                     const MonitoredItemCreateRequest& request,
                                     TimestampsToReturn timestamps)
{
    ItemRevision revision;
    MonitoredItemCreateResult result;
    std::unique_ptr<MonitoredItem> made = make_item(context, request, timestamps, revision);
    result.status_code = revision.status;
    result.filter_result = std::move(revision.filter_result);
    if (made == nullptr) {
        return result;
    }
    MonitoredItem& item = context.subscription.add_item(std::move(made));
    result.monitored_item_id = item.id();
    result.revised_sampling_interval = revision.sampling_interval;
    result.revised_queue_size = revision.queue_size;
    if (item.kind() == MonitoredItem::Kind::Data && item.mode() != MonitoringMode::Disabled) {
        context.all.sampler().add(static_cast<DataItem&>(item), context.now);
    }
    return result;
}

/// What SetTriggering came to for one of its links.
StatusCode add_link(Subscription& subscription, MonitoredItem& trigger, std::uint32_t id,
                    std::size_t max_links)
{
    MonitoredItem* const triggered = subscription.find_item(id);
    return triggered == nullptr ? StatusCode{status::Bad_MonitoredItemIdInvalid}
                                : trigger.add_link(*triggered, max_links);
}

StatusCode remove_link(Subscription& subscription, MonitoredItem& trigger, std::uint32_t id)
{
    MonitoredItem* const triggered = subscription.find_item(id);
    return triggered != nullptr && trigger.remove_link(*triggered)
               ? status::Good
               : status::Bad_MonitoredItemIdInvalid;
}

} // namespace

StatusCode create_monitored_items(Subscriptions& all, ServiceContext& context,
                                  const CreateMonitoredItemsRequest& request,
                                  CreateMonitoredItemsResponse& response)
{
    const auto subscription =
        find_subscription(all, context, request.subscription_id, request.items_to_create.size());
    if (!subscription) {
        return subscription.error();
    }
    if (!is_known(request.timestamps_to_return)) {
        return status::Bad_TimestampsToReturnInvalid;
    }
    const ItemContext item_context{all, **subscription, context.now};
    response.results.reserve(request.items_to_create.size());
    for (const MonitoredItemCreateRequest& item : request.items_to_create) {
        response.results.push_back(create_one(item_context, item, request.timestamps_to_return));
    }
    all.sampler().sample_new(context.now);
    return status::Good;
}

StatusCode modify_monitored_items(Subscriptions& all, ServiceContext& context,
                                  const ModifyMonitoredItemsRequest& request,
                                  ModifyMonitoredItemsResponse& response)
{
    const auto subscription =
        find_subscription(all, context, request.subscription_id, request.items_to_modify.size());
    if (!subscription) {
        return subscription.error();
    }
    if (!is_known(request.timestamps_to_return)) {
        return status::Bad_TimestampsToReturnInvalid;
    }
    const ItemContext item_context{all, **subscription, context.now};
    response.results.reserve(request.items_to_modify.size());
    for (const MonitoredItemModifyRequest& change : request.items_to_modify) {
        ItemRevision revision;
        if (MonitoredItem* item = (*subscription)->find_item(change.monitored_item_id)) {
            item->modify(item_context, change.requested_parameters, request.timestamps_to_return,
                         revision);
        } else {
            revision.status = status::Bad_MonitoredItemIdInvalid;
        }
        response.results.push_back({revision.status, revision.sampling_interval,
                                    revision.queue_size, std::move(revision.filter_result)});
    }
    all.sampler().sample_new(context.now);
    return status::Good;
}

StatusCode set_monitoring_mode(Subscriptions& all, ServiceContext& context,
                               const SetMonitoringModeRequest& request,
                               SetMonitoringModeResponse& response)
{
    const auto subscription =
        find_subscription(all, context, request.subscription_id, request.monitored_item_ids.size());
    if (!subscription) {
        return subscription.error();
    }
    if (!is_known(request.monitoring_mode)) {
        return status::Bad_MonitoringModeInvalid;
    }
    const ItemContext item_context{all, **subscription, context.now};
    response.results.reserve(request.monitored_item_ids.size());
    for (const std::uint32_t id : request.monitored_item_ids) {
        MonitoredItem* const item = (*subscription)->find_item(id);
        if (item != nullptr) {
            item->set_mode(item_context, request.monitoring_mode);
        }
        response.results.push_back(item != nullptr ? status::Good
                                                   : status::Bad_MonitoredItemIdInvalid);
    }
    all.sampler().sample_new(context.now);
    return status::Good;
}

StatusCode set_triggering(Subscriptions& all, ServiceContext& context,
                          const SetTriggeringRequest& request, SetTriggeringResponse& response)
{
    const auto subscription =
        find_subscription(all, context, request.subscription_id,
                          request.links_to_add.size() + request.links_to_remove.size());
    if (!subscription) {
        return subscription.error();
    }
    MonitoredItem* const trigger = (*subscription)->find_item(request.triggering_item_id);
    if (trigger == nullptr) {
        return status::Bad_MonitoredItemIdInvalid;
    }
    // Links are removed before others are added (Part 4, 5.13.5.2).
    for (const std::uint32_t id : request.links_to_remove) {
        response.remove_results.push_back(remove_link(**subscription, *trigger, id));
    }
    const std::size_t most = all.needs().limits.subscriptions.max_triggering_links;
    for (const std::uint32_t id : request.links_to_add) {
        response.add_results.push_back(add_link(**subscription, *trigger, id, most));
    }
    return status::Good;
}

StatusCode delete_monitored_items(Subscriptions& all, ServiceContext& context,
                                  const DeleteMonitoredItemsRequest& request,
                                  DeleteMonitoredItemsResponse& response)
{
    const auto subscription =
        find_subscription(all, context, request.subscription_id, request.monitored_item_ids.size());
    if (!subscription) {
        return subscription.error();
    }
    response.results.reserve(request.monitored_item_ids.size());
    for (const std::uint32_t id : request.monitored_item_ids) {
        response.results.push_back(
            (*subscription)->remove_item(id) ? status::Good : status::Bad_MonitoredItemIdInvalid);
    }
    return status::Good;
}

} // namespace busbar::server::detail

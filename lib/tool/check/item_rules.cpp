#include <busbar/types/filter.hpp>

#include "subscribed.hpp"

namespace busbar::tool::rules {

namespace {
namespace items {

constexpr std::uint32_t no_such_id = 0xFFFF'FFF0U;
constexpr std::uint32_t overflow_bit = 0x480; // InfoType DataValue with Overflow (Part 4, 7.38.1)

/// The result of creating one item.
Answer created(Subject& subject, MonitoredItemCreateRequest item)
{
    Subscribed subscription{subject};
    return operation_result(subscription.create({std::move(item)}));
}

template <typename Change>
Answer changed(Subject& subject, NodeId node, Change change)
{
    MonitoredItemCreateRequest item = item_of(std::move(node));
    change(item);
    return created(subject, std::move(item));
}

/// Judges the revised parameters of one item.
template <typename Change, typename Judge>
Answer revised(Subject& subject, Change change, Judge judge)
{
    Subscribed subscription{subject};
    MonitoredItemCreateRequest item = item_of(some_scalar());
    change(item.requested_parameters);
    return with(subscription.create({std::move(item)}),
                [&](const CreateMonitoredItemsResponse& response) {
                    return response.results.size() != 1 || response.results[0].status_code.is_bad()
                               ? wrong("the item was not created")
                               : judge(response.results[0]);
                });
}

Answer deadband(Subject& subject, NodeId node, std::uint32_t type, double value)
{
    return changed(subject, std::move(node), [&](MonitoredItemCreateRequest& item) {
        DataChangeFilter filter;
        filter.trigger = DataChangeTrigger::StatusValue;
        filter.deadband_type = type;
        filter.deadband_value = value;
        item.requested_parameters.filter = ExtensionObject::from(filter);
    });
}

MonitoredItemCreateRequest event_item(NodeId node, bool selects)
{
    MonitoredItemCreateRequest item = item_of(std::move(node));
    item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::EventNotifier);
    EventFilter filter;
    if (selects) {
        SimpleAttributeOperand& operand = filter.select_clauses.emplace_back();
        operand.type_definition_id = standard(id::BaseEventType);
        operand.browse_path = {QualifiedName{0, "EventId"}};
        operand.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    }
    item.requested_parameters.filter = ExtensionObject::from(std::move(filter));
    return item;
}

Answer different_ids(Subject& subject)
{
    Subscribed subscription{subject};
    const std::uint32_t first = subscription.add(item_of(some_scalar()));
    const std::uint32_t second = subscription.add(item_of(some_scalar()));
    return expect(first != second, "both have the id " + std::to_string(first));
}

Answer first_value(Subject& subject)
{
    Subscribed subscription{subject};
    static_cast<void>(subscription.add(item_of(some_array(), 4'711)));
    const auto values = values_of(subscription.next_data());
    return expect(values.size() == 1 && values[0].value.value.array_if<String>() != nullptr,
                  std::to_string(values.size()) + " values, or of another type");
}

Answer client_handle(Subject& subject)
{
    Subscribed subscription{subject};
    static_cast<void>(subscription.add(item_of(some_array(), 4'711)));
    const std::uint32_t handle = values_of(subscription.next_data())[0].client_handle;
    return expect(handle == 4'711, "clientHandle " + std::to_string(handle));
}

Answer item_timestamps(Subject& subject)
{
    Subscribed subscription{subject};
    static_cast<void>(subscription.create({item_of(some_scalar())}, TimestampsToReturn::Neither));
    const DataValue value = values_of(subscription.next_data())[0].value;
    return expect(value.source_timestamp == DateTime{} && value.server_timestamp == DateTime{},
                  "a timestamp");
}

Answer silent(Subject& subject, MonitoringMode mode)
{
    Subscribed subscription{subject};
    MonitoredItemCreateRequest item = item_of(some_scalar());
    item.monitoring_mode = mode;
    static_cast<void>(subscription.add(std::move(item)));
    // The second one comes after several publishing intervals.
    for (int i = 0; i < 2; ++i) {
        const PublishResponse message =
            subscription.publish_until([](const PublishResponse&) { return true; });
        if (!values_of(message).empty()) {
            return wrong("a value");
        }
    }
    return right();
}

/// The values of an item of a Variable that changes often, which has had a queue of this size for a
/// while.
std::vector<MonitoredItemNotification> overflown(Subject& subject, std::uint32_t queue_size,
                                                 bool discards_oldest)
{
    Subscribed subscription{subject};
    MonitoredItemCreateRequest item = item_of(some_scalar());
    item.requested_parameters.queue_size = queue_size;
    item.requested_parameters.discard_oldest = discards_oldest;
    const auto created = subscription.create({std::move(item)});
    if (!created || created->results.size() != 1 ||
        created->results[0].revised_queue_size != queue_size) {
        throw Refused{status::Bad_UnexpectedError, "a queue of this size"};
    }
    const double interval = std::max(created->results[0].revised_sampling_interval, 50.0);
    // The server's number may be infinite, or not a number: compare before converting it.
    const std::chrono::duration<double, std::milli> samples{interval * 3.5};
    if (!(samples <= subject.limit().left() / 2)) {
        throw Refused{status::Bad_ServiceUnsupported,
                      "a sampling interval that is short enough, see --rule-timeout"};
    }
    subscription.wait(std::chrono::duration_cast<Duration>(samples));
    return values_of(subscription.next_data());
}

bool has_overflow(const MonitoredItemNotification& value)
{
    return (value.value.status.value() & overflow_bit) == overflow_bit;
}

Answer overflow(Subject& subject, bool discards_oldest)
{
    const auto values = overflown(subject, 2, discards_oldest);
    if (values.size() != 2) {
        return wrong(std::to_string(values.size()) + " values");
    }
    return expect(has_overflow(values[discards_oldest ? 0 : 1]) &&
                      !has_overflow(values[discards_oldest ? 1 : 0]),
                  "the bit is not there, or at another value");
}

Answer no_overflow(Subject& subject)
{
    const auto values = overflown(subject, 1, true);
    return values.size() != 1 ? wrong(std::to_string(values.size()) + " values")
                              : expect(!has_overflow(values[0]), "the bit Overflow");
}

Result<ModifyMonitoredItemsResponse> modify(Subject& subject, std::uint32_t subscription,
                                            const std::vector<std::uint32_t>& ids,
                                            TimestampsToReturn timestamps)
{
    ModifyMonitoredItemsRequest request;
    request.subscription_id = subscription;
    request.timestamps_to_return = timestamps;
    for (const std::uint32_t id : ids) {
        request.items_to_modify.emplace_back().monitored_item_id = id;
    }
    return subject.ask<ModifyMonitoredItemsResponse>(std::move(request));
}

Result<SetMonitoringModeResponse> set_mode(Subject& subject, std::uint32_t subscription,
                                           Array<std::uint32_t> ids,
                                           MonitoringMode mode = MonitoringMode::Sampling)
{
    SetMonitoringModeRequest request;
    request.subscription_id = subscription;
    request.monitoring_mode = mode;
    request.monitored_item_ids = std::move(ids);
    return subject.ask<SetMonitoringModeResponse>(std::move(request));
}

Result<SetTriggeringResponse> trigger(Subject& subject, std::uint32_t subscription,
                                      std::uint32_t item, Array<std::uint32_t> added,
                                      Array<std::uint32_t> removed = {})
{
    SetTriggeringRequest request;
    request.subscription_id = subscription;
    request.triggering_item_id = item;
    request.links_to_add = std::move(added);
    request.links_to_remove = std::move(removed);
    return subject.ask<SetTriggeringResponse>(std::move(request));
}

Result<DeleteMonitoredItemsResponse> remove(Subject& subject, std::uint32_t subscription,
                                            Array<std::uint32_t> ids)
{
    DeleteMonitoredItemsRequest request;
    request.subscription_id = subscription;
    request.monitored_item_ids = std::move(ids);
    return subject.ask<DeleteMonitoredItemsResponse>(std::move(request));
}

Answer link_result(Subject& subject, bool adds)
{
    Subscribed subscription{subject};
    const std::uint32_t item = subscription.add(item_of(some_scalar()));
    const auto response = adds ? trigger(subject, subscription.id(), item, {no_such_id})
                               : trigger(subject, subscription.id(), item, {}, {no_such_id});
    if (!response) {
        return came(response.error());
    }
    const auto& results = adds ? response->add_results : response->remove_results;
    return results.size() == 1 ? came(results[0])
                               : wrong(std::to_string(results.size()) + " results");
}

Answer triggered(Subject& subject)
{
    Subscribed subscription{subject};
    MonitoredItemCreateRequest sampled = item_of(some_array(), 2);
    sampled.monitoring_mode = MonitoringMode::Sampling;
    const std::uint32_t linked = subscription.add(std::move(sampled));
    const std::uint32_t item = subscription.add(item_of(some_scalar(), 1));
    const auto response = trigger(subject, subscription.id(), item, {linked});
    if (!response) {
        return came(response.error());
    }
    const auto has_linked = [](const PublishResponse& message) {
        const auto values = values_of(message);
        return std::any_of(values.begin(), values.end(),
                           [](const auto& value) { return value.client_handle == 2; });
    };
    static_cast<void>(subscription.publish_until(has_linked));
    return right();
}

Answer removed_twice(Subject& subject)
{
    Subscribed subscription{subject};
    const std::uint32_t item = subscription.add(item_of(some_scalar()));
    static_cast<void>(remove(subject, subscription.id(), {item}));
    return operation_result(remove(subject, subscription.id(), {item}));
}

Answer modified(Subject& subject)
{
    Subscribed subscription{subject};
    const std::uint32_t item = subscription.add(item_of(some_scalar()));
    return operation_result(modify(subject, subscription.id(), {item}, TimestampsToReturn::Both));
}

Answer unknown_subscription(Subject& subject)
{
    CreateMonitoredItemsRequest request;
    request.subscription_id = no_such_id;
    request.items_to_create = {item_of(some_scalar())};
    return service_result(subject.ask<CreateMonitoredItemsResponse>(std::move(request)));
}

constexpr Wanted nothing{status::Bad_NothingToDo};
constexpr Wanted no_subscription{status::Bad_SubscriptionIdInvalid};
constexpr Wanted no_item{status::Bad_MonitoredItemIdInvalid};
constexpr Wanted bad_filter{
    status::Bad_DeadbandFilterInvalid, status::Bad_MonitoredItemFilterInvalid,
    status::Bad_MonitoredItemFilterUnsupported, status::Bad_FilterNotAllowed};
constexpr const char* create = "CreateMonitoredItems";
constexpr const char* service = "Part 4, 5.13.2.3";
constexpr const char* operation = "Part 4, 5.13.2.4";

const SpecRule rules[] = {
    {"item-nothing", create, "No items are refused", "itemsToCreate = []", nothing, service,
     [](Subject& subject) { return service_result(Subscribed{subject}.create({})); }},
    {"item-subscription-unknown", create, "A Subscription that is not there is refused",
     "subscriptionId = 4294967280", no_subscription, service, unknown_subscription},
    {"item-timestamps-invalid", create, "Unknown timestampsToReturn are refused",
     "timestampsToReturn = 99", status::Bad_TimestampsToReturnInvalid, service,
     [](Subject& subject) {
         return service_result(Subscribed{subject}.create({item_of(some_scalar())},
                                                          static_cast<TimestampsToReturn>(99)));
     }},
    {"item-timestamps-neither", create, "Neither returns no timestamp",
     "timestampsToReturn = Neither", "no timestamp", "Part 4, 5.13.2.2", item_timestamps},
    {"item-node-unknown", create, "A node that is not there is unknown",
     "a NodeId that does not exist", status::Bad_NodeIdUnknown, operation,
     [](Subject& subject) { return created(subject, item_of(unknown_node())); }},
    {"item-attribute-invalid", create, "A node does not have the attribute", "Value of Server",
     status::Bad_AttributeIdInvalid, operation,
     [](Subject& subject) { return created(subject, item_of(standard(id::Server))); }},
    {"item-range-syntax", create, "A range of letters is invalid", "indexRange = \"x\"",
     status::Bad_IndexRangeInvalid, operation,
     [](Subject& subject) {
         return changed(subject, some_array(), [](MonitoredItemCreateRequest& item) {
             item.item_to_monitor.index_range = "x";
         });
     }},
    {"item-range-no-data", create, "A range beyond the end fails now or in the Publish",
     "indexRange = \"99999\"", one_of(status::Good, status::Bad_IndexRangeNoData), operation,
     [](Subject& subject) {
         return changed(subject, some_array(), [](MonitoredItemCreateRequest& item) {
             item.item_to_monitor.index_range = "99999";
         });
     }},
    {"item-mode-invalid", create, "An unknown monitoringMode is refused", "monitoringMode = 9",
     status::Bad_MonitoringModeInvalid, operation,
     [](Subject& subject) {
         return changed(subject, some_scalar(), [](MonitoredItemCreateRequest& item) {
             item.monitoring_mode = static_cast<MonitoringMode>(9);
         });
     }},
    {"item-filter-unknown", create, "A filter of an unknown type is refused",
     "filter = a structure that is not a filter",
     one_of(status::Bad_MonitoredItemFilterInvalid, status::Bad_MonitoredItemFilterUnsupported,
            status::Bad_FilterNotAllowed),
     operation,
     [](Subject& subject) {
         return changed(subject, some_scalar(), [](MonitoredItemCreateRequest& item) {
             item.requested_parameters.filter = ExtensionObject::from(ReadValueId{});
         });
     }},
    {"item-event-filter-of-value", create, "A Value has no EventFilter",
     "Value of CurrentTime, filter = EventFilter",
     one_of(status::Bad_FilterNotAllowed, status::Bad_MonitoredItemFilterInvalid,
            status::Bad_MonitoredItemFilterUnsupported),
     operation,
     [](Subject& subject) {
         return changed(subject, some_scalar(), [](MonitoredItemCreateRequest& item) {
             item.requested_parameters.filter = ExtensionObject::from(EventFilter{});
         });
     }},
    {"item-filter-of-attribute", create, "The filter of a DisplayName is not used, or is refused",
     "DisplayName, filter = DataChangeFilter", one_of(status::Good, status::Bad_FilterNotAllowed),
     "Part 4, 5.13.1.1",
     [](Subject& subject) {
         return changed(subject, some_scalar(), [](MonitoredItemCreateRequest& item) {
             item.item_to_monitor.attribute_id =
                 static_cast<std::uint32_t>(AttributeId::DisplayName);
             item.requested_parameters.filter = ExtensionObject::from(DataChangeFilter{});
         });
     }},
    {"item-deadband-negative", create,
     "A negative deadband is granted, as each change is larger, or refused",
     "ServiceLevel, deadbandType = Absolute, deadbandValue = -1",
     one_of(status::Good, status::Bad_DeadbandFilterInvalid, status::Bad_MonitoredItemFilterInvalid,
            status::Bad_MonitoredItemFilterUnsupported, status::Bad_FilterNotAllowed),
     "Part 4, 7.22.2",
     [](Subject& subject) { return deadband(subject, standard(id::Server_ServiceLevel), 1, -1); }},
    {"item-deadband-type", create, "An unknown deadbandType is refused",
     "ServiceLevel, deadbandType = 7", bad_filter, "Part 4, 7.22.2",
     [](Subject& subject) { return deadband(subject, standard(id::Server_ServiceLevel), 7, 1); }},
    {"item-deadband-of-text", create, "A String has no deadband",
     "NamespaceArray, deadbandType = Absolute", bad_filter, "Part 4, 7.22.2",
     [](Subject& subject) { return deadband(subject, some_array(), 1, 1); }},
    {"item-percent-without-range", create, "A PercentDeadband needs an EURange",
     "ServiceLevel, deadbandType = Percent", bad_filter, "Part 8, 7.2",
     [](Subject& subject) { return deadband(subject, standard(id::Server_ServiceLevel), 2, 10); }},
    {"item-sampling-negative", create, "A negative interval is that of the Subscription",
     "samplingInterval = -1, publishing every 50 ms", "a revisedSamplingInterval above 0",
     "Part 4, 5.13.1.2",
     [](Subject& subject) {
         return revised(
             subject, [](MonitoringParameters& asked) { asked.sampling_interval = -1; },
             [](const MonitoredItemCreateResult& result) {
                 return expect(result.revised_sampling_interval > 0,
                               std::to_string(result.revised_sampling_interval));
             });
     }},
    {"item-queue-zero", create, "A queue of 0 values is one of 1", "queueSize = 0",
     "revisedQueueSize = 1", "Part 4, 7.21",
     [](Subject& subject) {
         return revised(
             subject, [](MonitoringParameters& asked) { asked.queue_size = 0; },
             [](const MonitoredItemCreateResult& result) {
                 return expect(result.revised_queue_size == 1,
                               std::to_string(result.revised_queue_size));
             });
     }},
    {"item-queue-large", create, "A very large queue is granted or revised",
     "queueSize = 4294967295", "a revisedQueueSize above 0", "Part 4, 7.21",
     [](Subject& subject) {
         return revised(
             subject, [](MonitoringParameters& asked) { asked.queue_size = 0xFFFF'FFFFU; },
             [](const MonitoredItemCreateResult& result) {
                 return expect(result.revised_queue_size > 0,
                               std::to_string(result.revised_queue_size));
             });
     }},
    {"item-ids", create, "Items of one node have ids of their own", "CurrentTime twice", "two ids",
     "Part 4, 5.13.2.2", different_ids},
    {"item-first-value", create, "The first value is reported without a change",
     "NamespaceArray, then Publish", "its value", "Part 4, 5.13.1.2", first_value},
    {"item-client-handle", create, "Values have the item's clientHandle", "clientHandle = 4711",
     "clientHandle 4711", "Part 4, 7.21", client_handle},
    {"item-disabled", create, "A disabled item reports nothing", "monitoringMode = Disabled",
     "keep-alive messages", "Part 4, 5.13.1.3",
     [](Subject& subject) { return silent(subject, MonitoringMode::Disabled); }},
    {"item-sampling", create, "An item that only samples reports nothing",
     "monitoringMode = Sampling", "keep-alive messages", "Part 4, 5.13.1.3",
     [](Subject& subject) { return silent(subject, MonitoringMode::Sampling); }},
    {"item-overflow-oldest", create, "The first value after lost ones says so",
     "CurrentTime, queueSize = 2, discardOldest = true", "Overflow at the first value",
     "Part 4, 5.13.1.5", [](Subject& subject) { return overflow(subject, true); }},
    {"item-overflow-newest", create, "The last value before lost ones says so",
     "CurrentTime, queueSize = 2, discardOldest = false", "Overflow at the last value",
     "Part 4, 5.13.1.5", [](Subject& subject) { return overflow(subject, false); }},
    {"item-overflow-none", create, "A queue of one value does not overflow",
     "CurrentTime, queueSize = 1", "no Overflow", "Part 4, 5.13.1.5", no_overflow},
    {"item-event", create, "Server reports events", "EventNotifier of Server, EventId",
     status::Good, operation,
     [](Subject& subject) { return created(subject, event_item(standard(id::Server), true)); }},
    {"item-event-selects-nothing", create, "An EventFilter selects fields",
     "EventNotifier of Server, selectClauses = []",
     one_of(status::Bad_EventFilterInvalid, status::Bad_MonitoredItemFilterInvalid),
     "Part 4, 7.22.3",
     [](Subject& subject) { return created(subject, event_item(standard(id::Server), false)); }},
    {"item-event-of-variable", create, "A Variable reports no events",
     "EventNotifier of CurrentTime", status::Bad_AttributeIdInvalid, operation,
     [](Subject& subject) { return created(subject, event_item(some_scalar(), true)); }},
    {"modify-items-nothing", "ModifyMonitoredItems", "No items are refused", "itemsToModify = []",
     nothing, "Part 4, 5.13.3.3",
     [](Subject& subject) {
         Subscribed subscription{subject};
         return service_result(modify(subject, subscription.id(), {}, TimestampsToReturn::Both));
     }},
    {"modify-items-subscription-unknown", "ModifyMonitoredItems",
     "A Subscription that is not there is refused", "subscriptionId = 4294967280", no_subscription,
     "Part 4, 5.13.3.3",
     [](Subject& subject) {
         return service_result(modify(subject, no_such_id, {1}, TimestampsToReturn::Both));
     }},
    {"modify-items-timestamps", "ModifyMonitoredItems", "Unknown timestampsToReturn are refused",
     "timestampsToReturn = 99", status::Bad_TimestampsToReturnInvalid, "Part 4, 5.13.3.3",
     [](Subject& subject) {
         Subscribed subscription{subject};
         const std::uint32_t item = subscription.add(item_of(some_scalar()));
         return service_result(
             modify(subject, subscription.id(), {item}, static_cast<TimestampsToReturn>(99)));
     }},
    {"modify-items-unknown", "ModifyMonitoredItems", "An item that is not there is invalid",
     "monitoredItemId = 4294967280", no_item, "Part 4, 5.13.3.4",
     [](Subject& subject) {
         Subscribed subscription{subject};
         return operation_result(
             modify(subject, subscription.id(), {no_such_id}, TimestampsToReturn::Both));
     }},
    {"modify-items", "ModifyMonitoredItems", "An item is modified", "an item of CurrentTime",
     status::Good, "Part 4, 5.13.3.4", modified},
    {"item-mode-nothing", "SetMonitoringMode", "No items are refused", "monitoredItemIds = []",
     nothing, "Part 4, 5.13.4.3",
     [](Subject& subject) {
         Subscribed subscription{subject};
         return service_result(set_mode(subject, subscription.id(), {}));
     }},
    {"item-mode-unknown", "SetMonitoringMode", "An item that is not there is invalid",
     "monitoredItemId = 4294967280", no_item, "Part 4, 5.13.4.4",
     [](Subject& subject) {
         Subscribed subscription{subject};
         return operation_result(set_mode(subject, subscription.id(), {no_such_id}));
     }},
    {"item-mode-set-invalid", "SetMonitoringMode", "An unknown monitoringMode is refused",
     "monitoringMode = 9", status::Bad_MonitoringModeInvalid, "Part 4, 5.13.4.3",
     [](Subject& subject) {
         Subscribed subscription{subject};
         const std::uint32_t item = subscription.add(item_of(some_scalar()));
         return service_result(
             set_mode(subject, subscription.id(), {item}, static_cast<MonitoringMode>(9)));
     }},
    {"item-mode-subscription-unknown", "SetMonitoringMode",
     "A Subscription that is not there is refused", "subscriptionId = 4294967280", no_subscription,
     "Part 4, 5.13.4.3",
     [](Subject& subject) { return service_result(set_mode(subject, no_such_id, {1})); }},
    {"trigger-nothing", "SetTriggering", "No links are refused",
     "linksToAdd = [], linksToRemove = []", nothing, "Part 4, 5.13.5.3",
     [](Subject& subject) {
         Subscribed subscription{subject};
         const std::uint32_t item = subscription.add(item_of(some_scalar()));
         return service_result(trigger(subject, subscription.id(), item, {}));
     }},
    {"trigger-item-unknown", "SetTriggering", "A triggering item that is not there is refused",
     "triggeringItemId = 4294967280", no_item, "Part 4, 5.13.5.3",
     [](Subject& subject) {
         Subscribed subscription{subject};
         const std::uint32_t item = subscription.add(item_of(some_scalar()));
         return service_result(trigger(subject, subscription.id(), no_such_id, {item}));
     }},
    {"trigger-link-unknown", "SetTriggering", "A link to an item that is not there is refused",
     "linksToAdd = [4294967280]", no_item, "Part 4, 5.13.5.4",
     [](Subject& subject) { return link_result(subject, true); }},
    {"trigger-remove-unknown", "SetTriggering", "A link that is not there cannot be removed",
     "linksToRemove = [4294967280]", no_item, "Part 4, 5.13.5.4",
     [](Subject& subject) { return link_result(subject, false); }},
    {"trigger-reports", "SetTriggering", "A triggered item reports its samples",
     "CurrentTime triggers NamespaceArray, which only samples", "the value of NamespaceArray",
     "Part 4, 5.13.1.6", triggered},
    {"delete-items-nothing", "DeleteMonitoredItems", "No items are refused",
     "monitoredItemIds = []", nothing, "Part 4, 5.13.6.3",
     [](Subject& subject) {
         Subscribed subscription{subject};
         return service_result(remove(subject, subscription.id(), {}));
     }},
    {"delete-items-unknown", "DeleteMonitoredItems", "An item that is not there is invalid",
     "monitoredItemId = 4294967280", no_item, "Part 4, 5.13.6.4",
     [](Subject& subject) {
         Subscribed subscription{subject};
         return operation_result(remove(subject, subscription.id(), {no_such_id}));
     }},
    {"delete-items-twice", "DeleteMonitoredItems", "A deleted item is not there",
     "the same item twice", no_item, "Part 4, 5.13.6.4", removed_twice},
    {"delete-items-subscription-unknown", "DeleteMonitoredItems",
     "A Subscription that is not there is refused", "subscriptionId = 4294967280", no_subscription,
     "Part 4, 5.13.6.3",
     [](Subject& subject) { return service_result(remove(subject, no_such_id, {1})); }},
};

} // namespace items
} // namespace

std::span<const SpecRule> item_rules()
{
    return items::rules;
}

} // namespace busbar::tool::rules

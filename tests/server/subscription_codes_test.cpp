#include <catch2/catch.hpp>

#include <array>
#include <string>

#include "subscription_fixture.hpp"

namespace subscription_codes_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

// One row for each StatusCode in the tables of the MonitoredItem and the Subscription Service Set
// (Part 4, 5.13.2 to 5.13.6 and 5.14.2 to 5.14.8), in their order. Codes that are common to all
// services are elsewhere.

namespace {

server::SubscriptionLimits few()
{
    auto limits = SubscriptionFixture::small_limits();
    limits.max_items_per_subscription = 2;
    limits.max_subscriptions_per_session = 2;
    return limits;
}

/// A client with a Subscription of one item, and another user's client.
struct CodeFixture : SubscriptionFixture {
    CodeFixture() : SubscriptionFixture{few()} {}

    template <typename Request>
    [[nodiscard]] Request request(std::uint32_t subscription) const
    {
        Request made;
        made.subscription_id = subscription;
        return made;
    }
    template <typename Request>
    [[nodiscard]] Request request() const
    {
        return request<Request>(id);
    }
    /// With so many operations, all of them default ones.
    template <typename Request, typename Element>
    [[nodiscard]] static Request with(Request request, Array<Element> Request::*operations,
                                      std::size_t count)
    {
        (request.*operations).resize(count);
        return request;
    }

    StatusCode create(const MonitoredItemCreateRequest& wanted)
    {
        return monitor(client, id, wanted).status_code;
    }
    StatusCode create(ExtensionObject filter)
    {
        auto wanted = item_request(level);
        wanted.requested_parameters.filter = std::move(filter);
        return create(wanted);
    }
    StatusCode create_range(const NodeId& node, const char* range)
    {
        auto wanted = item_request(node);
        wanted.item_to_monitor.index_range = range;
        return create(wanted);
    }
    StatusCode modify(std::uint32_t changed, ExtensionObject filter = {})
    {
        auto changes = with(request<ModifyMonitoredItemsRequest>(),
                            &ModifyMonitoredItemsRequest::items_to_modify, 1);
        changes.items_to_modify[0].monitored_item_id = changed;
        changes.items_to_modify[0].requested_parameters.filter = std::move(filter);
        const auto response = client.call<ModifyMonitoredItemsResponse>(changes);
        return response ? response->results[0].status_code : response.error();
    }
    StatusCode trigger(std::uint32_t triggering, std::uint32_t triggered)
    {
        auto links = request<SetTriggeringRequest>();
        links.triggering_item_id = triggering;
        links.links_to_add = {triggered};
        const auto response = client.call<SetTriggeringResponse>(links);
        return response ? response->add_results[0] : response.error();
    }
    StatusCode remove_item(std::uint32_t removed)
    {
        auto items = request<DeleteMonitoredItemsRequest>();
        items.monitored_item_ids = {removed};
        const auto response = client.call<DeleteMonitoredItemsResponse>(items);
        return response ? response->results[0] : response.error();
    }
    StatusCode modify_subscription(std::uint32_t subscription)
    {
        return client.status_of<ModifySubscriptionResponse>(
            request<ModifySubscriptionRequest>(subscription));
    }
    /// What an acknowledgement comes to.
    StatusCode acknowledge(SubscriptionAcknowledgement acknowledgement)
    {
        const auto sent = publish(client, {acknowledgement});
        advance(100ms);
        const auto response = take(client, sent);
        return response ? response->results[0] : response.error();
    }
    static StatusCode status_of_publish(TestClient& to, std::uint32_t sent)
    {
        return SubscriptionFixture::status_of(to, sent);
    }
    template <typename Response, typename Request>
    StatusCode status_of(Request sent)
    {
        return client.status_of<Response>(std::move(sent));
    }

    NodeId level{add_variable("level", 1)};
    TestClient client{log_in()};
    std::uint32_t id{subscribe(client)};
    std::uint32_t none{id + 1};
    std::uint32_t item{monitor(client, id, item_request(level)).monitored_item_id};
    std::uint32_t no_item{item + 1};
    TestClient other{log_in()};
};

using F = CodeFixture;
constexpr std::size_t too_many = 25'001;

ExtensionObject deadband(std::uint32_t type)
{
    DataChangeFilter filter;
    filter.trigger = DataChangeTrigger::StatusValue;
    filter.deadband_type = type;
    return ExtensionObject::from(filter);
}

struct Row {
    const char* section;
    StatusCode code;
    /// What the service, or its only operation, answers.
    StatusCode (*provoke)(F&);
};

const std::array monitored_item_rows{
    // CreateMonitoredItems
    Row{"5.13.2.3", status::Bad_NothingToDo,
        [](F& f) {
            return f.status_of<CreateMonitoredItemsResponse>(
                f.request<CreateMonitoredItemsRequest>());
        }},
    Row{"5.13.2.3", status::Bad_TooManyOperations,
        [](F& f) {
            return f.status_of<CreateMonitoredItemsResponse>(
                F::with(f.request<CreateMonitoredItemsRequest>(),
                        &CreateMonitoredItemsRequest::items_to_create, too_many));
        }},
    Row{"5.13.2.3", status::Bad_TimestampsToReturnInvalid,
        [](F& f) {
            return F::create_items(f.client, f.id, {F::item_request(f.level)},
                                   static_cast<TimestampsToReturn>(4))
                .error();
        }},
    Row{"5.13.2.3", status::Bad_SubscriptionIdInvalid,
        [](F& f) { return F::create_items(f.client, f.none, {F::item_request(f.level)}).error(); }},
    Row{"5.13.2.4", status::Bad_MonitoringModeInvalid,
        [](F& f) {
            auto item = F::item_request(f.level);
            item.monitoring_mode = static_cast<MonitoringMode>(3);
            return f.create(item);
        }},
    Row{"5.13.2.4", status::Bad_NodeIdInvalid,
        [](F& f) { return f.create(F::item_request(NodeId{})); }},
    Row{"5.13.2.4", status::Bad_NodeIdUnknown,
        [](F& f) {
            return f.create(F::item_request(NodeId{1, "nobody"}));
        }},
    Row{"5.13.2.4", status::Bad_AttributeIdInvalid,
        [](F& f) {
            auto item = F::item_request(f.level);
            item.item_to_monitor.attribute_id = 99;
            return f.create(item);
        }},
    Row{"5.13.2.4", status::Bad_IndexRangeInvalid,
        [](F& f) { return f.create_range(f.level, "2:1"); }},
    Row{"5.13.2.4", status::Bad_IndexRangeNoData,
        [](F& f) {
            model::NewVariable pair;
            pair.data_type = NodeId{0, id::Int32};
            pair.value_rank = 1;
            pair.array_dimensions = {2};
            return f.create_range(f.add_variable("pair", pair), "2");
        }},
    Row{"5.13.2.4", status::Bad_DataEncodingInvalid,
        [](F& f) {
            auto item = F::item_request(f.level);
            item.item_to_monitor.data_encoding = QualifiedName{0, "Default XML"};
            return f.create(item);
        }},
    Row{"5.13.2.4", status::Bad_MonitoredItemFilterInvalid,
        [](F& f) { return f.create(deadband(3)); }},
    Row{"5.13.2.4", status::Bad_MonitoredItemFilterUnsupported,
        [](F& f) { return f.create(ExtensionObject::from(AggregateFilter{})); }},
    Row{"5.13.2.4", status::Bad_FilterNotAllowed,
        [](F& f) { return f.create(ExtensionObject::from(EventFilter{})); }},
    Row{"5.13.2.4", status::Bad_TooManyMonitoredItems,
        [](F& f) {
            CHECK(f.create(F::item_request(f.level)) == status::Good);
            return f.create(F::item_request(f.level));
        }},
    // ModifyMonitoredItems
    Row{"5.13.3.3", status::Bad_NothingToDo,
        [](F& f) {
            return f.status_of<ModifyMonitoredItemsResponse>(
                f.request<ModifyMonitoredItemsRequest>());
        }},
    Row{"5.13.3.3", status::Bad_TooManyOperations,
        [](F& f) {
            return f.status_of<ModifyMonitoredItemsResponse>(
                F::with(f.request<ModifyMonitoredItemsRequest>(),
                        &ModifyMonitoredItemsRequest::items_to_modify, too_many));
        }},
    Row{"5.13.3.3", status::Bad_TimestampsToReturnInvalid,
        [](F& f) {
            auto request = F::with(f.request<ModifyMonitoredItemsRequest>(),
                                   &ModifyMonitoredItemsRequest::items_to_modify, 1);
            request.timestamps_to_return = static_cast<TimestampsToReturn>(4);
            return f.status_of<ModifyMonitoredItemsResponse>(request);
        }},
    Row{"5.13.3.3", status::Bad_SubscriptionIdInvalid,
        [](F& f) {
            return f.status_of<ModifyMonitoredItemsResponse>(
                f.request<ModifyMonitoredItemsRequest>(f.none));
        }},
    Row{"5.13.3.4", status::Bad_MonitoredItemIdInvalid, [](F& f) { return f.modify(f.no_item); }},
    Row{"5.13.3.4", status::Bad_MonitoredItemFilterInvalid,
        [](F& f) { return f.modify(f.item, deadband(3)); }},
    Row{"5.13.3.4", status::Bad_MonitoredItemFilterUnsupported,
        [](F& f) { return f.modify(f.item, ExtensionObject::from(AggregateFilter{})); }},
    Row{"5.13.3.4", status::Bad_FilterNotAllowed,
        [](F& f) { return f.modify(f.item, ExtensionObject::from(EventFilter{})); }},
    // SetMonitoringMode
    Row{"5.13.4.3", status::Bad_NothingToDo,
        [](F& f) {
            return f.status_of<SetMonitoringModeResponse>(f.request<SetMonitoringModeRequest>());
        }},
    Row{"5.13.4.3", status::Bad_TooManyOperations,
        [](F& f) {
            return f.status_of<SetMonitoringModeResponse>(
                F::with(f.request<SetMonitoringModeRequest>(),
                        &SetMonitoringModeRequest::monitored_item_ids, too_many));
        }},
    Row{"5.13.4.3", status::Bad_SubscriptionIdInvalid,
        [](F& f) { return F::set_mode(f.client, f.none, f.item, MonitoringMode::Sampling); }},
    Row{"5.13.4.3", status::Bad_MonitoringModeInvalid,
        [](F& f) { return F::set_mode(f.client, f.id, f.item, static_cast<MonitoringMode>(3)); }},
    Row{"5.13.4.4", status::Bad_MonitoredItemIdInvalid,
        [](F& f) { return F::set_mode(f.client, f.id, f.no_item, MonitoringMode::Sampling); }},
    // SetTriggering
    Row{"5.13.5.3", status::Bad_NothingToDo,
        [](F& f) { return f.status_of<SetTriggeringResponse>(f.request<SetTriggeringRequest>()); }},
    Row{"5.13.5.3", status::Bad_TooManyOperations,
        [](F& f) {
            return f.status_of<SetTriggeringResponse>(F::with(
                f.request<SetTriggeringRequest>(), &SetTriggeringRequest::links_to_add, too_many));
        }},
    Row{"5.13.5.3", status::Bad_SubscriptionIdInvalid,
        [](F& f) {
            return f.status_of<SetTriggeringResponse>(f.request<SetTriggeringRequest>(f.none));
        }},
    Row{"5.13.5.3", status::Bad_MonitoredItemIdInvalid,
        [](F& f) { return f.trigger(f.no_item, f.item); }},
    Row{"5.13.5.4", status::Bad_MonitoredItemIdInvalid,
        [](F& f) { return f.trigger(f.item, f.no_item); }},
    // DeleteMonitoredItems
    Row{"5.13.6.3", status::Bad_NothingToDo,
        [](F& f) {
            return f.status_of<DeleteMonitoredItemsResponse>(
                f.request<DeleteMonitoredItemsRequest>());
        }},
    Row{"5.13.6.3", status::Bad_TooManyOperations,
        [](F& f) {
            return f.status_of<DeleteMonitoredItemsResponse>(
                F::with(f.request<DeleteMonitoredItemsRequest>(),
                        &DeleteMonitoredItemsRequest::monitored_item_ids, too_many));
        }},
    Row{"5.13.6.3", status::Bad_SubscriptionIdInvalid,
        [](F& f) {
            return f.status_of<DeleteMonitoredItemsResponse>(
                f.request<DeleteMonitoredItemsRequest>(f.none));
        }},
    Row{"5.13.6.4", status::Bad_MonitoredItemIdInvalid,
        [](F& f) { return f.remove_item(f.no_item); }},
};

const std::array subscription_rows{
    // CreateSubscription
    Row{"5.14.2.3", status::Bad_TooManySubscriptions,
        [](F& f) {
            f.subscribe(f.client);
            return f.status_of<CreateSubscriptionResponse>(F::subscription_request());
        }},
    // ModifySubscription
    Row{"5.14.3.3", status::Bad_SubscriptionIdInvalid,
        [](F& f) { return f.modify_subscription(f.none); }},
    // SetPublishingMode
    Row{"5.14.4.3", status::Bad_NothingToDo,
        [](F& f) { return f.status_of<SetPublishingModeResponse>(SetPublishingModeRequest{}); }},
    Row{"5.14.4.3", status::Bad_TooManyOperations,
        [](F& f) {
            return f.status_of<SetPublishingModeResponse>(F::with(
                SetPublishingModeRequest{}, &SetPublishingModeRequest::subscription_ids, too_many));
        }},
    Row{"5.14.4.4", status::Bad_SubscriptionIdInvalid,
        [](F& f) { return F::set_publishing(f.client, f.none, true); }},
    // Publish
    Row{"5.14.5.3", status::Bad_TooManyPublishRequests,
        [](F& f) {
            const auto oldest = F::publish(f.client);
            for (int i = 0; i < 5; ++i) {
                F::publish(f.client);
            }
            return f.status_of_publish(f.client, oldest);
        }},
    Row{"5.14.5.3", status::Bad_NoSubscription,
        [](F& f) { return f.status_of_publish(f.other, F::publish(f.other)); }},
    Row{"5.14.5.4", status::Bad_SubscriptionIdInvalid,
        [](F& f) {
            return f.acknowledge({f.none, 1});
        }},
    Row{"5.14.5.4", status::Bad_SequenceNumberUnknown,
        [](F& f) {
            return f.acknowledge({f.id, 7});
        }},
    // Good_RetransmissionQueueNotSupported cannot be provoked: there is such a queue.
    // Republish
    Row{"5.14.6.3", status::Bad_SubscriptionIdInvalid,
        [](F& f) { return F::republish(f.client, f.none, 1).error(); }},
    Row{"5.14.6.3", status::Bad_MessageNotAvailable,
        [](F& f) { return F::republish(f.client, f.id, 1).error(); }},
    // TransferSubscriptions
    Row{"5.14.7.3", status::Bad_NothingToDo,
        [](F& f) {
            return f.status_of<TransferSubscriptionsResponse>(TransferSubscriptionsRequest{});
        }},
    Row{"5.14.7.3", status::Bad_TooManyOperations,
        [](F& f) {
            return f.status_of<TransferSubscriptionsResponse>(
                F::with(TransferSubscriptionsRequest{},
                        &TransferSubscriptionsRequest::subscription_ids, too_many));
        }},
    // Bad_InsufficientClientProfile cannot be provoked: no Subscription needs any profile.
    Row{"5.14.7.4", status::Bad_SubscriptionIdInvalid,
        [](F& f) { return F::transfer(f.client, f.none).status_code; }},
    Row{"5.14.7.4", status::Bad_UserAccessDenied,
        [](F& f) { return F::transfer(f.other, f.id).status_code; }},
    Row{"5.14.7.4", status::Bad_TooManySubscriptions,
        [](F& f) {
            const auto secure = setting("Basic256Sha256", MessageSecurityMode::Sign);
            auto from = f.log_in(secure);
            auto to = f.log_in(secure);
            const auto moved = f.subscribe(from);
            f.subscribe(to);
            f.subscribe(to);
            return F::transfer(to, moved).status_code;
        }},
    Row{"5.14.7.4", status::Bad_NothingToDo,
        [](F& f) { return F::transfer(f.client, f.id).status_code; }},
    // DeleteSubscriptions
    Row{"5.14.8.3", status::Bad_NothingToDo,
        [](F& f) {
            return f.status_of<DeleteSubscriptionsResponse>(DeleteSubscriptionsRequest{});
        }},
    Row{"5.14.8.3", status::Bad_TooManyOperations,
        [](F& f) {
            return f.status_of<DeleteSubscriptionsResponse>(
                F::with(DeleteSubscriptionsRequest{}, &DeleteSubscriptionsRequest::subscription_ids,
                        too_many));
        }},
    Row{"5.14.8.4", status::Bad_SubscriptionIdInvalid,
        [](F& f) { return F::remove(f.client, f.none); }},
};

void check(std::span<const Row> rows)
{
    for (const Row& row : rows) {
        INFO(row.section << " " << name(row.code));
        CodeFixture fixture;
        CHECK(row.provoke(fixture) == row.code);
    }
}

} // namespace

TEST_CASE("every StatusCode of the MonitoredItem services")
{
    check(monitored_item_rows);
}

TEST_CASE("every StatusCode of the Subscription services")
{
    check(subscription_rows);
}

} // namespace subscription_codes_test

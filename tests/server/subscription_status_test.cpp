#include <catch2/catch.hpp>

#include "subscription_fixture.hpp"

namespace subscription_status_test {

// How requests are refused in combinations, and what that leaves behind; that no StatusCode is
// missing is for the table in subscription_codes_test.cpp.

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

server::SubscriptionLimits few()
{
    auto limits = SubscriptionFixture::small_limits();
    limits.max_items_per_subscription = 3;
    limits.max_items = 4;
    limits.max_acknowledgements = 2;
    limits.max_subscriptions_per_session = 2;
    return limits;
}

struct StatusFixture : SubscriptionFixture {
    StatusFixture() : SubscriptionFixture{few()} {}

    NodeId level{add_variable("level", 1)};
    TestClient client{log_in()};
    std::uint32_t id{subscribe(client)};
};

/// Refuses with `text`: a request without operations, and one with too many.
template <typename Response, typename Request, typename Element>
void check_counts(TestClient& client, Request request, Array<Element> Request::*operations)
{
    CHECK(client.status_of<Response>(request) == status::Bad_NothingToDo);
    (request.*operations).resize(25'001);
    CHECK(client.status_of<Response>(request) == status::Bad_TooManyOperations);
}

template <typename Request>
Request of(std::uint32_t subscription)
{
    Request request;
    request.subscription_id = subscription;
    return request;
}

MonitoredItemCreateRequest with_range(const NodeId& node, const char* range)
{
    auto item = SubscriptionFixture::item_request(node);
    item.item_to_monitor.index_range = range;
    return item;
}

ExtensionObject change_filter(std::uint32_t deadband_type, double value,
                              DataChangeTrigger trigger = DataChangeTrigger::StatusValue)
{
    DataChangeFilter filter;
    filter.trigger = trigger;
    filter.deadband_type = deadband_type;
    filter.deadband_value = value;
    return ExtensionObject::from(filter);
}

} // namespace

TEST_CASE_METHOD(StatusFixture, "statuses of requests for Subscriptions")
{
    check_counts<SetPublishingModeResponse>(client, SetPublishingModeRequest{},
                                            &SetPublishingModeRequest::subscription_ids);
    check_counts<TransferSubscriptionsResponse>(client, TransferSubscriptionsRequest{},
                                                &TransferSubscriptionsRequest::subscription_ids);
    check_counts<DeleteSubscriptionsResponse>(client, DeleteSubscriptionsRequest{},
                                              &DeleteSubscriptionsRequest::subscription_ids);
    const std::uint32_t none = id + 1;
    ModifySubscriptionRequest modify;
    modify.subscription_id = none;
    CHECK(client.status_of<ModifySubscriptionResponse>(modify) ==
          status::Bad_SubscriptionIdInvalid);
    CHECK(set_publishing(client, none, true) == status::Bad_SubscriptionIdInvalid);
    CHECK(remove(client, none) == status::Bad_SubscriptionIdInvalid);
    CHECK(transfer(client, none).status_code == status::Bad_SubscriptionIdInvalid);
    CHECK(republish(client, none, 1).error() == status::Bad_SubscriptionIdInvalid);
    // Bad_TooManySubscriptions is row 2, Bad_NothingToDo of a transfer row 22,
    // Bad_UserAccessDenied row 24 and Bad_MessageNotAvailable row 21 of the state test.
}

TEST_CASE("a transfer to a session that has all it may have answers Bad_TooManySubscriptions")
{
    const auto secure = setting("Basic256Sha256", MessageSecurityMode::Sign);
    SubscriptionFixture fixture{few()};
    auto old_client = fixture.log_in(secure);
    auto new_client = fixture.log_in(secure);
    const auto id = fixture.subscribe(old_client);
    fixture.subscribe(new_client);
    const auto last = fixture.subscribe(new_client);
    CHECK(fixture.transfer(new_client, id).status_code == status::Bad_TooManySubscriptions);
    CHECK(fixture.remove(new_client, last) == status::Good);
    CHECK(fixture.transfer(new_client, id).status_code == status::Good);
}

TEST_CASE_METHOD(StatusFixture, "statuses of Publish")
{
    auto other = log_in();
    CHECK(status_of(other, publish(other)) == status::Bad_NoSubscription);

    std::vector<std::uint32_t> requests;
    for (int i = 0; i < 6; ++i) {
        requests.push_back(publish(client));
    }
    // The oldest gives way (Part 4, 5.14.5.1).
    CHECK(status_of(client, requests[0]) == status::Bad_TooManyPublishRequests);
    CHECK(status_of(client, requests[1]) == status::Bad_WouldBlock);
    advance(100ms);
    CHECK(status_of(client, requests[1]) == status::Good);

    const auto id_of_other = subscribe(other);
    const auto acknowledging = publish(client, {{id, 7}, {id_of_other, 1}});
    for (int i = 0; i < 30; ++i) {
        advance(100ms);
    }
    const auto answer = take(client, acknowledging);
    REQUIRE(answer);
    CHECK(answer->results ==
          Array<StatusCode>{status::Bad_SequenceNumberUnknown, status::Bad_SubscriptionIdInvalid});
    CHECK(status_of(client, publish(client, {{id, 1}, {id, 2}, {id, 3}})) ==
          status::Bad_TooManyOperations);
}

TEST_CASE_METHOD(StatusFixture, "an acknowledged message is gone")
{
    CHECK(monitor(client, id, item_request(level)).status_code == status::Good);
    const auto first = publish(client);
    advance(100ms);
    CHECK(take(client, first));
    const auto second = publish(client, {{id, 1}});
    set(0, 2);
    advance(100ms);
    advance(100ms);
    const auto response = take(client, second);
    REQUIRE(response);
    CHECK(response->results == Array<StatusCode>{status::Good});
    CHECK(response->available_sequence_numbers == Array<std::uint32_t>{2});
    CHECK(republish(client, id, 1).error() == status::Bad_MessageNotAvailable);
}

TEST_CASE_METHOD(StatusFixture, "statuses of requests for items")
{
    check_counts<CreateMonitoredItemsResponse>(client, of<CreateMonitoredItemsRequest>(id),
                                               &CreateMonitoredItemsRequest::items_to_create);
    check_counts<ModifyMonitoredItemsResponse>(client, of<ModifyMonitoredItemsRequest>(id),
                                               &ModifyMonitoredItemsRequest::items_to_modify);
    check_counts<SetMonitoringModeResponse>(client, of<SetMonitoringModeRequest>(id),
                                            &SetMonitoringModeRequest::monitored_item_ids);
    check_counts<SetTriggeringResponse>(client, of<SetTriggeringRequest>(id),
                                        &SetTriggeringRequest::links_to_add);
    check_counts<DeleteMonitoredItemsResponse>(client, of<DeleteMonitoredItemsRequest>(id),
                                               &DeleteMonitoredItemsRequest::monitored_item_ids);
    auto other = log_in(); // whose Subscription it is not
    CHECK(other.status_of<CreateMonitoredItemsResponse>(of<CreateMonitoredItemsRequest>(id)) ==
          status::Bad_SubscriptionIdInvalid);
    CHECK(other.status_of<ModifyMonitoredItemsResponse>(of<ModifyMonitoredItemsRequest>(id)) ==
          status::Bad_SubscriptionIdInvalid);
    CHECK(other.status_of<SetMonitoringModeResponse>(of<SetMonitoringModeRequest>(id)) ==
          status::Bad_SubscriptionIdInvalid);
    CHECK(other.status_of<SetTriggeringResponse>(of<SetTriggeringRequest>(id)) ==
          status::Bad_SubscriptionIdInvalid);
    CHECK(other.status_of<DeleteMonitoredItemsResponse>(of<DeleteMonitoredItemsRequest>(id)) ==
          status::Bad_SubscriptionIdInvalid);

    CHECK(create_items(client, id, {item_request(level)}, static_cast<TimestampsToReturn>(4))
              .error() == status::Bad_TimestampsToReturnInvalid);
    auto modify = of<ModifyMonitoredItemsRequest>(id);
    modify.items_to_modify.resize(1);
    modify.timestamps_to_return = static_cast<TimestampsToReturn>(-1);
    CHECK(client.status_of<ModifyMonitoredItemsResponse>(modify) ==
          status::Bad_TimestampsToReturnInvalid);
    CHECK(set_mode(client, id, 1, static_cast<MonitoringMode>(3)) ==
          status::Bad_MonitoringModeInvalid);
}

TEST_CASE_METHOD(StatusFixture, "items have the DataEncodings of structures (Part 4, 7.29)")
{
    model::NewVariable range;
    range.data_type = NodeId{0, id::Range};
    const NodeId structure = add_variable("range", range);
    const auto encoded_as = [&](const NodeId& node, const char* encoding) {
        auto item = item_request(node);
        item.item_to_monitor.data_encoding = QualifiedName{0, encoding};
        return monitor(client, id, item).status_code;
    };
    for (const char* const other : {"Default XML", "Default JSON", "Mine"}) {
        CHECK(encoded_as(structure, other) == status::Bad_DataEncodingUnsupported);
    }
    for (const char* const any : {"Default Binary", "Default XML", "Default JSON", "Mine"}) {
        CHECK(encoded_as(level, any) == status::Bad_DataEncodingInvalid);
    }
    CHECK(encoded_as(structure, "Default Binary") == status::Good);
}

TEST_CASE_METHOD(StatusFixture, "statuses of items that are created")
{
    const auto status_of_item = [&](const MonitoredItemCreateRequest& item) {
        return monitor(client, id, item).status_code;
    };
    auto item = item_request(level);
    item.monitoring_mode = static_cast<MonitoringMode>(7);
    CHECK(status_of_item(item) == status::Bad_MonitoringModeInvalid);
    CHECK(status_of_item(item_request(NodeId{})) == status::Bad_NodeIdInvalid);
    CHECK(status_of_item(item_request(NodeId{1, "nobody"})) == status::Bad_NodeIdUnknown);
    item = item_request(level);
    item.item_to_monitor.attribute_id = 99;
    CHECK(status_of_item(item) == status::Bad_AttributeIdInvalid);
    CHECK(status_of_item(with_range(level, "2:1")) == status::Bad_IndexRangeInvalid);
    model::NewVariable fixed;
    fixed.data_type = NodeId{0, id::Int32};
    fixed.value_rank = 1;
    fixed.array_dimensions = {2};
    const NodeId row = add_variable("row", fixed);
    CHECK(status_of_item(with_range(row, "2")) == status::Bad_IndexRangeNoData);
    item = item_request(level);
    item.requested_parameters.filter = change_filter(3, 1);
    CHECK(status_of_item(item) == status::Bad_MonitoredItemFilterInvalid);
    item.requested_parameters.filter = change_filter(0, 1, static_cast<DataChangeTrigger>(9));
    CHECK(status_of_item(item) == status::Bad_MonitoredItemFilterInvalid);
    item.requested_parameters.filter = ExtensionObject::from(AggregateFilter{});
    CHECK(status_of_item(item) == status::Bad_MonitoredItemFilterUnsupported);
    item.requested_parameters.filter = ExtensionObject::from(EventFilter{});
    CHECK(status_of_item(item) == status::Bad_FilterNotAllowed);
    item.requested_parameters.filter = change_filter(1, 1);
    item.item_to_monitor.attribute_id = 3; // BrowseName
    CHECK(status_of_item(item) == status::Bad_FilterNotAllowed);
    // Part 8, 7.2.
    item = item_request(level);
    item.requested_parameters.filter = change_filter(2, 10);
    CHECK(status_of_item(item) == status::Bad_DeadbandFilterInvalid);
    item.requested_parameters.filter = change_filter(1, -1);
    CHECK(status_of_item(item) == status::Bad_DeadbandFilterInvalid);

    // None of these took a place.
    for (int i = 0; i < 3; ++i) {
        CHECK(status_of_item(item_request(level)) == status::Good);
    }
    CHECK(status_of_item(item_request(level)) == status::Bad_TooManyMonitoredItems);
    const auto second = subscribe(client);
    CHECK(monitor(client, second, item_request(level)).status_code == status::Good);
    CHECK(monitor(client, second, item_request(level)).status_code ==
          status::Bad_TooManyMonitoredItems);
}

TEST_CASE_METHOD(StatusFixture, "statuses of items that are changed", "[unit:Monitor Basic]")
{
    const auto made = monitor(client, id, item_request(level));
    const auto modify = [&](std::uint32_t item, const ExtensionObject& filter) {
        auto request = of<ModifyMonitoredItemsRequest>(id);
        request.items_to_modify.resize(1);
        request.items_to_modify[0].monitored_item_id = item;
        request.items_to_modify[0].requested_parameters.filter = filter;
        const auto response = client.call<ModifyMonitoredItemsResponse>(request);
        return response ? response->results[0].status_code : response.error();
    };
    const std::uint32_t item = made.monitored_item_id;
    const std::uint32_t none = item + 1;
    CHECK(modify(none, {}) == status::Bad_MonitoredItemIdInvalid);
    CHECK(modify(item, change_filter(9, 0)) == status::Bad_MonitoredItemFilterInvalid);
    CHECK(modify(item, ExtensionObject::from(AggregateFilter{})) ==
          status::Bad_MonitoredItemFilterUnsupported);
    CHECK(modify(item, ExtensionObject::from(EventFilter{})) == status::Bad_FilterNotAllowed);
    CHECK(modify(item, change_filter(1, 5)) == status::Good);

    CHECK(set_mode(client, id, none, MonitoringMode::Sampling) ==
          status::Bad_MonitoredItemIdInvalid);
    auto triggering = of<SetTriggeringRequest>(id);
    triggering.triggering_item_id = none;
    triggering.links_to_add = {item};
    CHECK(client.status_of<SetTriggeringResponse>(triggering) ==
          status::Bad_MonitoredItemIdInvalid);
    triggering.triggering_item_id = item;
    triggering.links_to_add = {none};
    triggering.links_to_remove = {item};
    const auto links = client.call<SetTriggeringResponse>(triggering);
    REQUIRE(links);
    CHECK(links->add_results == Array<StatusCode>{status::Bad_MonitoredItemIdInvalid});
    CHECK(links->remove_results == Array<StatusCode>{status::Bad_MonitoredItemIdInvalid});
    auto remove_items = of<DeleteMonitoredItemsRequest>(id);
    remove_items.monitored_item_ids = {item, item};
    const auto removed = client.call<DeleteMonitoredItemsResponse>(remove_items);
    REQUIRE(removed);
    CHECK(removed->results == Array<StatusCode>{status::Good, status::Bad_MonitoredItemIdInvalid});
}

} // namespace subscription_status_test

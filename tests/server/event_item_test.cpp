#include <catch2/catch.hpp>

#include <algorithm>

#include "event_item_fixture.hpp"

namespace event_item_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using enum FilterOperator;

namespace {

using Messages = std::vector<std::string>;
const char* const lost = "Events were lost";

} // namespace

TEST_CASE_METHOD(EventFixture, "raised events are published with the fields that were selected",
                 "[unit:Address Space Events][unit:Address Space Events 2]"
                 "[unit:Monitor Events]")
{
    const auto made = monitor(
        client, id,
        event_request(selecting({"EventId", "EventType", "SourceName", "Severity", "Nothing"})));
    REQUIRE(made.status_code == status::Good);
    CHECK(made.revised_queue_size == 10);
    CHECK(made.revised_sampling_interval == 0);
    const auto* result = made.filter_result.get_if<EventFilterResult>();
    REQUIRE(result != nullptr);
    CHECK(result->select_clause_results[0] == status::Good);
    CHECK(result->select_clause_results[4] == status::Bad_NodeIdUnknown);

    server::Event event;
    event.event_type = NodeId{0, id::DeviceFailureEventType};
    event.source_name = "Press";
    event.severity = 700;
    CHECK(server.raise_event(event));
    CHECK(server.event_queue()->raise(event));
    server.handle_completions(now);
    const auto events = next_events(client);
    REQUIRE(events.size() == 2);
    CHECK(events[0].client_handle == 7);
    REQUIRE(events[0].event_fields.size() == 5);
    CHECK(events[0].event_fields[0].get_if<ByteString>()->size() == 16);
    CHECK(events[0].event_fields[0] != events[1].event_fields[0]);
    CHECK(events[0].event_fields[1] == Variant{NodeId{0, id::DeviceFailureEventType}});
    CHECK(events[0].event_fields[2] == Variant{"Press"});
    CHECK(events[0].event_fields[3] == Variant{std::uint16_t{700}});
    CHECK(events[0].event_fields[4].is_null());
    CHECK(next_events(client).empty());
}

TEST_CASE_METHOD(EventFixture, "an item gets what its filter lets pass")
{
    EventFilter filter = selecting({"Message"});
    where(filter, GreaterThanOrEqual, {of("Severity"), literal(500)});
    CHECK(monitor(client, id, event_request(filter)).filter_result.is_null());
    raise("low", 499);
    raise("high", 500);
    CHECK(next_messages(client) == Messages{"high"});
}

TEST_CASE_METHOD(EventFixture, "items that cannot be say why")
{
    const auto status_with = [&](auto change) {
        auto item = event_request();
        change(item);
        const auto made = monitor(client, id, item);
        CHECK(made.monitored_item_id == 0);
        return made.status_code;
    };
    const NodeId silent = add_notifier("silent", 0);
    const NodeId variable = add_variable("variable", 1);
    CHECK(status_with([&](auto& item) { item.item_to_monitor.node_id = silent; }) ==
          status::Bad_NotSupported);
    CHECK(status_with([&](auto& item) { item.item_to_monitor.node_id = variable; }) ==
          status::Bad_AttributeIdInvalid);
    CHECK(status_with([&](auto& item) {
              item.item_to_monitor.node_id = NodeId{1, "nowhere"};
          }) == status::Bad_NodeIdUnknown);
    CHECK(status_with([&](auto& item) { item.item_to_monitor.index_range = "1:0"; }) ==
          status::Bad_IndexRangeInvalid);
    CHECK(status_with([&](auto& item) { item.item_to_monitor.index_range = "1"; }) ==
          status::Bad_IndexRangeNoData);
    const auto filter_status = [&](ExtensionObject filter) {
        return status_with([&](auto& item) { item.requested_parameters.filter = filter; });
    };
    CHECK(filter_status({}) == status::Bad_MonitoredItemFilterInvalid);
    CHECK(filter_status(ExtensionObject::from(DataChangeFilter{})) == status::Bad_FilterNotAllowed);
    CHECK(filter_status(ExtensionObject::from_binary(NodeId{0, 727U}, ByteString{})) ==
          status::Bad_MonitoredItemFilterInvalid);
    CHECK(filter_status(ExtensionObject::from(EventFilter{})) == status::Bad_EventFilterInvalid);

    EventFilter wrong = selecting({"Message"});
    where(wrong, RelatedTo, {});
    const auto made = monitor(client, id, event_request(wrong));
    CHECK(made.status_code == status::Bad_EventFilterInvalid);
    const auto* result = made.filter_result.get_if<EventFilterResult>();
    REQUIRE(result != nullptr);
    CHECK(result->where_clause_result.element_results[0].status_code ==
          status::Bad_FilterOperatorUnsupported);
    CHECK(server.monitored_item_count() == 0);
    raise("nobody listens");
}

TEST_CASE_METHOD(EventFixture, "events go up the hierarchy of notifiers",
                 "[unit:Address Space Notifier Hierarchy]"
                 "[unit:Address Space Source Hierarchy]")
{
    const NodeId area = add_notifier("area");
    const NodeId press = add_notifier("press", 0);
    const NodeId other = add_notifier("other");
    link(NodeId{0, id::Server}, id::HasNotifier, area);
    link(area, id::HasEventSource, press);
    for (const NodeId& notifier : {NodeId{0, id::Server}, area, other}) {
        REQUIRE(monitor(client, id, event_request(selecting({"Message"}), notifier)).status_code ==
                status::Good);
    }
    raise("of the press", 1, press);
    CHECK(next_messages(client).size() == 2);
    raise("of the other", 1, other);
    CHECK(next_messages(client).size() == 2);
    raise("of the server");
    CHECK(next_messages(client).size() == 1);
    // A node that comes after another in its place gets none of its items' events.
    auto& space = server.address_space();
    REQUIRE(space.remove(space.find(other)));
    const NodeId next = add_notifier("next");
    raise("of the next", 1, next);
    CHECK(next_messages(client).size() == 1);
}

TEST_CASE_METHOD(EventFixture, "an event of a type that is none is dropped with a warning")
{
    monitor(client, id, event_request());
    server::Event event;
    event.event_type = NodeId{1, "no type"};
    CHECK(server.raise_event(event));
    event.event_type = NodeId{0, id::Server};
    CHECK(server.raise_event(event));
    server.handle_completions(now);
    CHECK(next_events(client).empty());
    CHECK(log.text.find("is not an event type") != std::string::npos);
}

TEST_CASE_METHOD(EventFixture, "a full queue has an overflow event on top of its size",
                 "[unit:Base Info EventQueueOverflow EventType]")
{
    EventFilter filter = selecting({"Message", "EventType", "SourceNode", "SourceName"});
    where(filter, LessThan, {of("Severity"), literal(0)}); // which the overflow event bypasses
    filter.where_clause.elements[0].filter_operator = GreaterThan;
    auto item = event_request(filter);
    item.requested_parameters.queue_size = 2;
    item.requested_parameters.discard_oldest = true;
    monitor(client, id, item);
    for (const char* message : {"1", "2", "3", "4"}) {
        raise(message);
    }
    const auto events = next_events(client);
    REQUIRE(events.size() == 3);
    CHECK(events[0].event_fields[1] == Variant{NodeId{0, id::EventQueueOverflowEventType}});
    CHECK(events[0].event_fields[2] == Variant{NodeId{0, id::Server}});
    CHECK(events[0].event_fields[3] == Variant{"Internal/EventQueueOverflow"});
    CHECK(events[1].event_fields[0] == Variant{LocalizedText{"3"}});
    CHECK(events[2].event_fields[0] == Variant{LocalizedText{"4"}});

    item.requested_parameters.discard_oldest = false;
    const auto second = subscribe(client);
    CHECK(remove(client, id) == status::Good);
    monitor(client, second, item);
    for (const char* message : {"1", "2", "3"}) {
        raise(message);
    }
    CHECK(next_messages(client) == Messages{"1", "3", lost});
}

TEST_CASE_METHOD(EventFixture, "an event that the server had no place for is told to every item")
{
    monitor(client, id, event_request());
    for (int i = 0; i < 1'024; ++i) {
        REQUIRE(server.raise_event({}));
    }
    CHECK_FALSE(server.raise_event({}));
    server.handle_completions(now);
    const Messages messages = next_messages(client);
    CHECK(messages.size() == 11);
    CHECK(messages.front() == lost);
    raise("next");
    CHECK(next_messages(client) == Messages{"next"});
}

TEST_CASE_METHOD(EventFixture, "filter and queue of an item can be changed, or stay as they were")
{
    const auto made = monitor(client, id, event_request());
    ModifyMonitoredItemsRequest request;
    request.subscription_id = id;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.items_to_modify.resize(2);
    auto& changes = request.items_to_modify;
    changes[0].monitored_item_id = made.monitored_item_id;
    changes[0].requested_parameters = event_request().requested_parameters;
    changes[0].requested_parameters.client_handle = 9;
    // The same item twice in one request, the second time with a filter that is none.
    EventFilter wrong = selecting({"Message"});
    where(wrong, Not, {element(0)});
    changes[1] = changes[0];
    changes[0].requested_parameters.queue_size = 1;
    changes[0].requested_parameters.filter = ExtensionObject::from(selecting({"Severity"}));
    changes[1].requested_parameters.client_handle = 11;
    changes[1].requested_parameters.filter = ExtensionObject::from(wrong);
    raise("1", 1);
    raise("2", 2);
    const auto modified = client.call<ModifyMonitoredItemsResponse>(request);
    REQUIRE(modified);
    CHECK(modified->results[0].status_code == status::Good);
    CHECK(modified->results[0].revised_queue_size == 1);
    CHECK(modified->results[1].status_code == status::Bad_EventFilterInvalid);
    CHECK_FALSE(modified->results[1].filter_result.is_null());
    auto events = next_events(client);
    REQUIRE(events.size() == 2); // what was lost was told with the new filter
    CHECK(events[0].client_handle == 9);
    CHECK(events[1].event_fields[0] == Variant{LocalizedText{"2"}});
    raise("3", 3);
    events = next_events(client);
    REQUIRE(events.size() == 1);
    CHECK(events[0].event_fields[0] == Variant{std::uint16_t{3}});
}

TEST_CASE_METHOD(EventFixture, "queue sizes are revised", "[unit:Monitor QueueSize_ServerMax]")
{
    const auto revised = [&](std::uint32_t requested) {
        auto item = event_request();
        item.requested_parameters.queue_size = requested;
        return monitor(client, id, item).revised_queue_size;
    };
    CHECK(revised(0) == 1'000);
    CHECK(revised(1) == 1);
    CHECK(revised(UINT32_MAX) == 10'000);
}

TEST_CASE_METHOD(EventFixture, "a disabled item gets nothing and forgets what it had")
{
    auto item = event_request();
    item.monitoring_mode = MonitoringMode::Disabled;
    const auto made = monitor(client, id, item);
    raise("unheard");
    CHECK(set_mode(client, id, made.monitored_item_id, MonitoringMode::Reporting) == status::Good);
    raise("forgotten");
    CHECK(set_mode(client, id, made.monitored_item_id, MonitoringMode::Disabled) == status::Good);
    CHECK(set_mode(client, id, made.monitored_item_id, MonitoringMode::Sampling) == status::Good);
    raise("kept");
    CHECK(next_events(client).empty());
    CHECK(set_mode(client, id, made.monitored_item_id, MonitoringMode::Reporting) == status::Good);
    CHECK(next_messages(client) == Messages{"kept"});
}

TEST_CASE_METHOD(EventFixture, "events are queued while no session is there to get them")
{
    monitor(client, id, event_request());
    CloseSessionRequest close;
    close.delete_subscriptions = false;
    REQUIRE(client.call<CloseSessionResponse>(close));
    raise("meanwhile");
    CHECK(remove(client, id).is_bad());
    raise("still");
    CHECK(server.subscription_count() == 1);
    // Its lifetime ends with nobody there, and its item with it.
    for (int i = 0; i < 200; ++i) {
        advance(100ms);
    }
    CHECK(server.subscription_count() == 0);
    raise("to nobody");
}

TEST_CASE_METHOD(EventFixture, "items that fail cost nothing that lasts")
{
    EventFilter wrong = selecting({"Message"});
    where(wrong, Not, {element(0)});
    for (int i = 0; i < 2'000; ++i) {
        REQUIRE(monitor(client, id, event_request(wrong)).status_code.is_bad());
    }
    CHECK(server.monitored_item_count() == 0);
    CHECK(monitor(client, id, event_request()).status_code == status::Good);
}

// Part 4, 7.22.3.
TEST_CASE_METHOD(EventFixture, "fields that no response can take give way to a reason")
{
    auto small = connect();
    auto create = small.create_request();
    create.max_response_message_size = 10'000;
    REQUIRE(small.create_session(create));
    REQUIRE(small.activate(small.anonymous()) == status::Good);
    const auto subscription = subscribe(small);
    monitor(small, subscription, event_request(selecting({"SourceName", "Message", "Severity"})));
    server::Event event;
    event.source_name = String{std::string(6'000, 's')};
    event.message = LocalizedText{String{std::string(7'000, 'm')}};
    event.severity = 300;
    CHECK(server.raise_event(event));
    event.message = LocalizedText{"fits"};
    CHECK(server.raise_event(event));
    server.handle_completions(now);

    auto events = next_events(small);
    REQUIRE(events.size() == 1);
    REQUIRE(events[0].event_fields.size() == 3);
    // The largest, and no more than has to be.
    CHECK(events[0].event_fields[0] == Variant{event.source_name});
    CHECK(events[0].event_fields[1] == Variant{status::Bad_EncodingLimitsExceeded});
    CHECK(events[0].event_fields[2] == Variant{std::uint16_t{300}});
    events = next_events(small);
    REQUIRE(events.size() == 1);
    CHECK(events[0].event_fields[0] == Variant{event.source_name});
    CHECK(events[0].event_fields[1] == Variant{event.message});
}

TEST_CASE_METHOD(EventFixture, "the end of the server is an event, of the time where it stands",
                 "[unit:Base Info System Status][unit:Base Info LocalTime Events]")
{
    monitor(client, id, event_request(selecting({"EventType", "SystemState", "LocalTime"})));
    server.begin_shutdown(now, "maintenance");
    const auto events = next_events(client);
    REQUIRE(events.size() == 1);
    CHECK(events[0].event_fields[0] == Variant{NodeId{0, id::SystemStatusChangeEventType}});
    CHECK(events[0].event_fields[1] == Variant{ServerState::Shutdown});
    const auto* const time = events[0].event_fields[2].get_if<ExtensionObject>();
    REQUIRE(time != nullptr);
    REQUIRE(time->get_if<TimeZoneDataType>() != nullptr);
    CHECK(*time->get_if<TimeZoneDataType>() == TimeZoneDataType{}); // the wall clock's
}

TEST_CASE_METHOD(EventFixture, "events do not wait for data that never ends")
{
    auto request = subscription_request();
    request.max_notifications_per_publish = GENERATE(1U, 3U);
    const auto narrow = subscribe(client, request);
    std::vector<NodeId> variables;
    for (const char* name : {"a", "b", "c", "d", "e"}) {
        variables.push_back(add_variable(name, 0));
        monitor(client, narrow, item_request(variables.back()));
    }
    monitor(client, narrow, event_request());
    for (int i = 0; i < 20; ++i) {
        raise("door open");
        for (std::size_t v = 0; v < variables.size(); ++v) {
            set(v, i + 1);
        }
        next_events(client);
    }
    raise("fire");
    Messages messages;
    std::size_t changes = 0;
    for (int i = 0; i < 60; ++i) {
        for (std::size_t v = 0; v < variables.size(); ++v) {
            set(v, i + 100);
        }
        const std::uint32_t sent = publish(client);
        advance(cycle);
        const auto response = take(client, sent);
        REQUIRE(response);
        changes += data(response->notification_message).size();
        for (const ExtensionObject& part : response->notification_message.notification_data) {
            if (const auto* list = part.get_if<EventNotificationList>()) {
                for (const EventFieldList& event : list->events) {
                    messages.push_back(
                        event.event_fields[0].value_or<LocalizedText>(LocalizedText{}).text.str());
                }
            }
        }
    }
    CHECK(std::find(messages.begin(), messages.end(), "fire") != messages.end());
    CHECK(changes > 0); // nor the other way round
}

TEST_CASE_METHOD(EventFixture, "an event has a status in place of a field that is not UTF-8")
{
    const auto made = monitor(client, id, event_request(selecting({"Message", "Severity"})));
    REQUIRE(made.status_code == status::Good);
    raise("ok\xFF\xFE", 500);
    const auto events = next_events(client);
    REQUIRE(events.size() == 1);
    CHECK(events[0].event_fields[0] == Variant{status::Bad_EncodingError});
    CHECK(events[0].event_fields[1] == Variant{std::uint16_t{500}});
}

} // namespace event_item_test

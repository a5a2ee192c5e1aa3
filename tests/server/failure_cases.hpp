#pragma once

#include <busbar/types/attribute.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/node_management.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "event_fixture.hpp"
#include "failure_fixture.hpp"

/// A request for each service that a server answers, and what there has to be before it.
namespace busbar::test::failing {

inline const NodeId objects{0, id::ObjectsFolder};

inline FailureCase find_servers(FailureFixture&)
{
    FindServersRequest request;
    request.endpoint_url = "opc.tcp://localhost:4840";
    return asking<FindServersResponse>(request);
}

inline FailureCase get_endpoints(FailureFixture&)
{
    GetEndpointsRequest request;
    request.endpoint_url = "opc.tcp://localhost:4840";
    return asking<GetEndpointsResponse>(request);
}

inline FailureCase create_session(FailureFixture& world)
{
    return asking<CreateSessionResponse>(world.client.create_request());
}

inline FailureCase activate_session(FailureFixture& world)
{
    REQUIRE(world.client.create_session());
    ActivateSessionRequest request;
    request.user_identity_token = TestClient::anonymous();
    request.locale_ids = {"en-US-of-a-length", "de-DE-of-another-length"};
    FailureCase asked = asking<ActivateSessionResponse>(request);
    asked.dies_with_connection = true; // until it is activated (Part 4, 5.7.3.1)
    return asked;
}

/// A user whose password a worker checks.
inline FailureCase log_in_by_worker(FailureFixture& world)
{
    world.users.used_worker = &world.worker;
    world.client = world.connect("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);
    REQUIRE(world.client.create_session());
    ActivateSessionRequest request;
    request.client_signature = world.client.signature();
    request.user_identity_token = world.client.user("operator", "operator-secret");
    FailureCase asked = asking<ActivateSessionResponse>(request);
    asked.dies_with_connection = true; // until it is activated (Part 4, 5.7.3.1)
    return asked;
}

inline FailureCase close_session(FailureFixture& world)
{
    world.subscribe();
    CloseSessionRequest request;
    request.delete_subscriptions = true;
    return asking<CloseSessionResponse>(request);
}

inline FailureCase cancel(FailureFixture& world)
{
    world.subscribe();
    world.client.send(PublishRequest{});
    CancelRequest request;
    request.request_handle = world.client.last_handle;
    return asking<CancelResponse>(request);
}

inline ReadValueId value_of(const NodeId& node)
{
    ReadValueId id;
    id.node_id = node;
    id.attribute_id = 13;
    return id;
}

inline FailureCase read(FailureFixture&)
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Both;
    request.nodes_to_read = {value_of(FailureFixture::own("level")),
                             value_of(FailureFixture::own("speed")),
                             value_of(NodeId{0, id::Server_ServerStatus})};
    return asking<ReadResponse>(request);
}

inline FailureCase write(FailureFixture&)
{
    WriteRequest request;
    request.nodes_to_write.resize(2);
    request.nodes_to_write[0].node_id = FailureFixture::own("level");
    request.nodes_to_write[1].node_id = FailureFixture::own("speed");
    for (WriteValue& value : request.nodes_to_write) {
        value.attribute_id = 13;
        value.value.value = 7;
    }
    return asking<WriteResponse>(request);
}

inline BrowseRequest browse_request(std::uint32_t most = 0)
{
    BrowseRequest request;
    request.requested_max_references_per_node = most;
    request.nodes_to_browse.resize(1);
    request.nodes_to_browse[0].node_id = objects;
    request.nodes_to_browse[0].result_mask = 63;
    return request;
}

inline FailureCase browse(FailureFixture&)
{
    return asking<BrowseResponse>(browse_request());
}

inline FailureCase browse_in_part(FailureFixture&)
{
    return asking<BrowseResponse>(browse_request(1));
}

inline FailureCase browse_next(FailureFixture& world)
{
    const auto begun = world.client.call<BrowseResponse>(browse_request(1));
    REQUIRE(begun);
    BrowseNextRequest request;
    request.continuation_points = {begun->results[0].continuation_point};
    return asking<BrowseNextResponse>(request);
}

inline FailureCase translate_browse_paths(FailureFixture&)
{
    TranslateBrowsePathsToNodeIdsRequest request;
    request.browse_paths.resize(2);
    for (BrowsePath& path : request.browse_paths) {
        path.starting_node = objects;
        path.relative_path.elements.resize(1);
        path.relative_path.elements[0].include_subtypes = true;
        path.relative_path.elements[0].target_name = QualifiedName{1, "level"};
    }
    return asking<TranslateBrowsePathsToNodeIdsResponse>(request);
}

inline FailureCase register_nodes(FailureFixture&)
{
    RegisterNodesRequest request;
    request.nodes_to_register = {FailureFixture::own("level"), FailureFixture::own("speed")};
    return asking<RegisterNodesResponse>(request);
}

inline FailureCase unregister_nodes(FailureFixture&)
{
    UnregisterNodesRequest request;
    request.nodes_to_unregister = {FailureFixture::own("level")};
    return asking<UnregisterNodesResponse>(request);
}

inline FailureCase call(FailureFixture& world)
{
    world.add_method();
    CallRequest request;
    request.methods_to_call = {{objects, FailureFixture::own("sum"), {Variant{1}, Variant{2}}},
                               {objects, FailureFixture::own("sum"), {Variant{3}, Variant{4}}}};
    return asking<CallResponse>(request);
}

inline FailureCase create_subscription(FailureFixture&)
{
    return asking<CreateSubscriptionResponse>(FailureFixture::subscription_request());
}

inline FailureCase modify_subscription(FailureFixture& world)
{
    ModifySubscriptionRequest request;
    request.subscription_id = world.subscribe();
    request.requested_publishing_interval = 500;
    request.requested_lifetime_count = 40;
    request.requested_max_keep_alive_count = 4;
    return asking<ModifySubscriptionResponse>(request);
}

inline FailureCase set_publishing_mode(FailureFixture& world)
{
    SetPublishingModeRequest request;
    request.subscription_ids = {world.subscribe(), world.subscribe()};
    return asking<SetPublishingModeResponse>(request);
}

inline FailureCase delete_subscriptions(FailureFixture& world)
{
    const std::uint32_t first = world.subscribe();
    world.monitor(first);
    DeleteSubscriptionsRequest request;
    request.subscription_ids = {first};
    return asking<DeleteSubscriptionsResponse>(request);
}

inline FailureCase transfer_subscriptions(FailureFixture& world)
{
    world.client = world.log_in_as("operator");
    world.monitor(world.subscribe());
    TransferSubscriptionsRequest request;
    request.subscription_ids = {world.subscribe()};
    request.send_initial_values = true;
    world.left = std::make_unique<TestClient>(std::move(world.client));
    world.client = world.log_in_as("operator");
    return asking<TransferSubscriptionsResponse>(request);
}

inline FailureCase create_items(FailureFixture& world)
{
    return asking<CreateMonitoredItemsResponse>(FailureFixture::items_request(world.subscribe()));
}

inline EventFilter event_filter()
{
    EventFilter filter = selecting({"Message", "Severity", "EventType"});
    where(filter, FilterOperator::GreaterThan,
          {of("Severity"), literal(Variant{std::uint16_t{10}})});
    return filter;
}

inline CreateMonitoredItemsRequest event_item(std::uint32_t subscription)
{
    CreateMonitoredItemsRequest request = FailureFixture::items_request(subscription);
    request.items_to_create.resize(1);
    MonitoredItemCreateRequest& item = request.items_to_create[0];
    item.item_to_monitor.node_id = NodeId{0, id::Server};
    item.item_to_monitor.attribute_id = 12;
    item.requested_parameters.queue_size = 10;
    item.requested_parameters.filter = ExtensionObject::from(event_filter());
    return request;
}

inline FailureCase create_event_item(FailureFixture& world)
{
    return asking<CreateMonitoredItemsResponse>(event_item(world.subscribe()));
}

inline FailureCase modify_items(FailureFixture& world)
{
    ModifyMonitoredItemsRequest request;
    request.subscription_id = world.subscribe();
    for (const std::uint32_t item : world.monitor(request.subscription_id)) {
        MonitoredItemModifyRequest change;
        change.monitored_item_id = item;
        change.requested_parameters.sampling_interval = 300;
        change.requested_parameters.queue_size = 20;
        request.items_to_modify.push_back(change);
    }
    return asking<ModifyMonitoredItemsResponse>(request);
}

inline FailureCase set_monitoring_mode(FailureFixture& world)
{
    SetMonitoringModeRequest request;
    request.subscription_id = world.subscribe();
    request.monitoring_mode = MonitoringMode::Disabled;
    request.monitored_item_ids = Array<std::uint32_t>{world.monitor(request.subscription_id)};
    REQUIRE(world.client.call<SetMonitoringModeResponse>(request));
    request.monitoring_mode = MonitoringMode::Reporting;
    return asking<SetMonitoringModeResponse>(request);
}

inline FailureCase set_triggering(FailureFixture& world)
{
    SetTriggeringRequest request;
    request.subscription_id = world.subscribe();
    const auto items = world.monitor(request.subscription_id);
    request.triggering_item_id = items[0];
    request.links_to_add = {items[1]};
    return asking<SetTriggeringResponse>(request);
}

inline FailureCase delete_items(FailureFixture& world)
{
    DeleteMonitoredItemsRequest request;
    request.subscription_id = world.subscribe();
    request.monitored_item_ids = Array<std::uint32_t>{world.monitor(request.subscription_id)};
    return asking<DeleteMonitoredItemsResponse>(request);
}

/// Good if it brings something; Bad_NoData for a keep-alive.
inline FailureCase publish_something()
{
    return {asking<PublishResponse>(PublishRequest{}).send,
            [](TestClient& client, std::uint32_t id) -> StatusCode {
                const auto response = client.take<PublishResponse>(id);
                if (!response) {
                    return response.error();
                }
                return response->notification_message.notification_data.empty()
                           ? StatusCode{status::Bad_NoData}
                           : status::Good;
            },
            false};
}

inline FailureCase publish_data(FailureFixture& world)
{
    world.monitor(world.subscribe());
    return publish_something();
}

inline FailureCase publish_events(FailureFixture& world)
{
    REQUIRE(world.client.call<CreateMonitoredItemsResponse>(event_item(world.subscribe())));
    server::Event event;
    event.message = LocalizedText{"a message that does not fit into a small string"};
    event.severity = 500;
    event.source_node = NodeId{0, id::Server};
    REQUIRE(world.server.raise_event(std::move(event)));
    world.server.handle_completions(world.now);
    return publish_something();
}

inline FailureCase republish(FailureFixture& world)
{
    RepublishRequest request;
    request.subscription_id = world.subscribe();
    world.monitor(request.subscription_id);
    request.retransmit_sequence_number = 1;
    REQUIRE(world.ask(world.client, publish_something()) == status::Good);
    return asking<RepublishResponse>(request);
}

inline FailureCase add_nodes(FailureFixture&)
{
    AddNodesRequest request;
    request.nodes_to_add.resize(2);
    std::size_t i = 0;
    for (AddNodesItem& item : request.nodes_to_add) {
        const NodeId node = FailureFixture::own(i++ == 0 ? "a new node" : "another new node");
        item.parent_node_id = objects;
        item.reference_type_id = NodeId{0, id::Organizes};
        item.requested_new_node_id = node;
        item.browse_name = QualifiedName{1, node.string()};
        item.node_class = NodeClass::Object;
        item.type_definition = NodeId{0, id::FolderType};
    }
    return asking<AddNodesResponse>(request);
}

inline FailureCase delete_nodes(FailureFixture& world)
{
    REQUIRE(world.ask(world.client, add_nodes(world)) == status::Good);
    DeleteNodesRequest request;
    request.nodes_to_delete = {{FailureFixture::own("a new node"), true}};
    return asking<DeleteNodesResponse>(request);
}

inline FailureCase add_references(FailureFixture& world)
{
    REQUIRE(world.ask(world.client, add_nodes(world)) == status::Good);
    AddReferencesRequest request;
    request.references_to_add = {{FailureFixture::own("a new node"), NodeId{0, id::Organizes}, true,
                                  String{}, FailureFixture::own("another new node"),
                                  NodeClass::Object}};
    return asking<AddReferencesResponse>(request);
}

inline FailureCase delete_references(FailureFixture& world)
{
    REQUIRE(world.ask(world.client, add_references(world)) == status::Good);
    DeleteReferencesRequest request;
    request.references_to_delete = {{FailureFixture::own("a new node"), NodeId{0, id::Organizes},
                                     true, FailureFixture::own("another new node"), true}};
    return asking<DeleteReferencesResponse>(request);
}

} // namespace busbar::test::failing

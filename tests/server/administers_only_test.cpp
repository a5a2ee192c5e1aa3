#include <catch2/catch.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>

#include <busbar/server/method_table.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "session_use.hpp"

namespace administers_only_test {

// SH-082679, 9.7: a user with the permission "Configuration tool only" has no business with data,
// whichever service asks for it.

using namespace busbar;
using namespace busbar::test;

namespace {

struct Table {
    server::MethodTable methods;
};

/// A Variable "Value" and a Method "Go" in the namespace of the server's application, which is 1,
/// and in one of a model, which is 2.
struct TwoNamespaces : Table, ServerFixture {
    TwoNamespaces() : ServerFixture{ServerFixture::insecure_config()}
    {
        users.everybody.access_level_mask = 0xFF;
        users.everybody.roles = {"ConfigureAdmin", "SecurityAdmin", "Operator"};
        users.everybody.administers_only = true;
        REQUIRE(space().add_namespace("urn:model") == 2);
        const std::uint32_t source = server.add_source(methods);
        for (const std::uint16_t index : {std::uint16_t{1}, std::uint16_t{2}}) {
            model::NewVariable variable;
            variable.access_level = model::Access::ReadWrite;
            variable.data_type = NodeId{0, id::Int32};
            variable.value = std::int32_t{7};
            REQUIRE(space().add_variable(named(index, "Value"), variable));
            model::NewMethod method;
            method.source = source;
            method.handle = methods.add([this](server::MethodCall call) {
                ++calls;
                call.succeed({});
            });
            REQUIRE(space().add_method(named(index, "Go"), method));
        }
    }
    [[nodiscard]] model::AddressSpace& space() { return server.address_space(); }
    [[nodiscard]] model::NewNode named(std::uint16_t index, const char* name)
    {
        model::NewNode node;
        node.id = NodeId{index, name};
        node.browse_name = QualifiedName{index, name};
        node.parent = space().find(id::ObjectsFolder);
        return node;
    }
    [[nodiscard]] static DataValue read(TestClient& client, const NodeId& node,
                                        AttributeId attribute = AttributeId::Value)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = node;
        request.nodes_to_read[0].attribute_id = static_cast<std::uint32_t>(attribute);
        auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] static StatusCode write(TestClient& client, const NodeId& node)
    {
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = node;
        request.nodes_to_write[0].attribute_id = 13;
        request.nodes_to_write[0].value = DataValue{Variant{std::int32_t{8}}};
        const auto response = client.call<WriteResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] static StatusCode call(TestClient& client, const NodeId& method)
    {
        CallRequest request;
        request.methods_to_call.resize(1);
        request.methods_to_call[0].object_id = NodeId{0, id::ObjectsFolder};
        request.methods_to_call[0].method_id = method;
        const auto response = client.call<CallResponse>(request);
        REQUIRE(response);
        return response->results[0].status_code;
    }
    /// A MonitoredItem, or what it reports first.
    [[nodiscard]] StatusCode subscribe(TestClient& client, const NodeId& node)
    {
        CreateSubscriptionRequest subscription;
        subscription.requested_publishing_interval = 100;
        subscription.requested_lifetime_count = 30;
        subscription.requested_max_keep_alive_count = 3;
        subscription.publishing_enabled = true;
        const auto made = client.call<CreateSubscriptionResponse>(subscription);
        REQUIRE(made);
        CreateMonitoredItemsRequest items;
        items.subscription_id = made->subscription_id;
        MonitoredItemCreateRequest& item = items.items_to_create.emplace_back();
        item.item_to_monitor.node_id = node;
        item.item_to_monitor.attribute_id = 13;
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.queue_size = 1;
        const auto created = client.call<CreateMonitoredItemsResponse>(items);
        REQUIRE(created);
        if (created->results[0].status_code.is_bad()) {
            return created->results[0].status_code;
        }
        const std::uint32_t publish = client.send(PublishRequest{});
        advance(std::chrono::milliseconds{200});
        const auto response = client.take<PublishResponse>(publish);
        REQUIRE(response);
        REQUIRE(response->notification_message.notification_data.size() == 1);
        const auto* const data =
            response->notification_message.notification_data[0].get_if<DataChangeNotification>();
        REQUIRE(data != nullptr);
        return data->monitored_items[0].value.status;
    }
    [[nodiscard]] static NodeId registered(TestClient& client, const NodeId& node)
    {
        RegisterNodesRequest request;
        request.nodes_to_register = {node};
        const auto response = client.call<RegisterNodesResponse>(request);
        REQUIRE(response);
        return response->registered_node_ids[0];
    }
    [[nodiscard]] static std::size_t browse(TestClient& client)
    {
        BrowseRequest request;
        request.nodes_to_browse.resize(1);
        request.nodes_to_browse[0].node_id = NodeId{0, id::ObjectsFolder};
        request.nodes_to_browse[0].browse_direction = BrowseDirection::Forward;
        request.nodes_to_browse[0].result_mask = 63;
        auto response = client.call<BrowseResponse>(request);
        REQUIRE(response);
        std::size_t found = 0;
        for (const auto& each : response->results[0].references) {
            found += each.browse_name.name.view() == "Value" ? 1U : 0U;
        }
        return found;
    }

    int calls{0};
};

const NodeId own_value{1, "Value"};
const NodeId model_value{2, "Value"};

} // namespace

TEST_CASE_METHOD(TwoNamespaces, "who only administers has no access to data by any service")
{
    auto client = log_in();
    constexpr auto denied = status::Bad_UserAccessDenied;
    CHECK(read(client, model_value).status == denied);
    CHECK(read(client, model_value).value.is_null());
    CHECK(write(client, model_value) == denied);
    CHECK(subscribe(client, model_value) == denied);
    CHECK(call(client, NodeId{2, "Go"}) == denied);
    CHECK(calls == 0);
    const NodeId alias = registered(client, model_value);
    CHECK(read(client, alias).status == denied);
    CHECK(write(client, alias) == denied);
    // The attributes say so, of reading, writing and history (Part 3, 8.57).
    CHECK(read(client, model_value, AttributeId::UserAccessLevel).value ==
          Variant{std::uint8_t{0}});
    CHECK(read(client, NodeId{2, "Go"}, AttributeId::UserExecutable).value == Variant{false});
    // What there is may be seen: it is in the project, which is his to read.
    CHECK(browse(client) == 2);
    CHECK(read(client, model_value, AttributeId::DisplayName).status == status::Good);
}

TEST_CASE_METHOD(TwoNamespaces, "who only administers has access to what is the server's own")
{
    auto client = log_in();
    CHECK(read(client, own_value).value == Variant{std::int32_t{7}});
    CHECK(subscribe(client, own_value) == status::Good);
    CHECK(write(client, own_value) == status::Good);
    CHECK(call(client, NodeId{1, "Go"}) == status::Good);
    CHECK(read(client, NodeId{0, id::Server_NamespaceArray}).status == status::Good);
    CHECK(read(client, NodeId{0, id::Server_ServerStatus_State}).status == status::Good);
}

TEST_CASE_METHOD(TwoNamespaces, "who does more than administer has access to data")
{
    users.everybody.administers_only = false;
    auto client = log_in();
    CHECK(read(client, model_value).value == Variant{std::int32_t{7}});
    CHECK(subscribe(client, model_value) == status::Good);
    CHECK(write(client, model_value) == status::Good);
    CHECK(call(client, NodeId{2, "Go"}) == status::Good);
}

} // namespace administers_only_test

#include <catch2/catch.hpp>

#include <algorithm>
#include <utility>

#include <busbar/server/conformance.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "support/server_fixture.hpp"

namespace server_object_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

DataValue read(TestClient& client, std::uint32_t node)
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Source;
    request.nodes_to_read.resize(1);
    request.nodes_to_read[0].node_id = NodeId{0, node};
    request.nodes_to_read[0].attribute_id = 13;
    const auto response = client.call<ReadResponse>(request);
    return response ? response->results[0] : DataValue{response.error()};
}

} // namespace

TEST_CASE("the Server object tells how the server is",
          "[unit:Base Info Core Structure][unit:Base Info Core Structure 2]"
          "[unit:Base Info Server Capabilities]"
          "[unit:Base Info Server Capabilities 2]")
{
    auto config = ServerFixture::insecure_config();
    config.build.manufacturer_name = "Maker";
    config.limits.operations.max_nodes_per_read = 12;
    ServerFixture fixture{std::move(config)};
    auto client = fixture.log_in();
    fixture.advance(5s);

    const auto status = read(client, id::Server_ServerStatus);
    const auto* object = status.value.get_if<ExtensionObject>();
    REQUIRE(object != nullptr);
    const auto* data = object->get_if<ServerStatusDataType>();
    REQUIRE(data != nullptr);
    CHECK(data->start_time == today);
    CHECK(data->current_time == fixture.wall_clock.time);
    CHECK(data->state == ServerState::Running);
    CHECK(data->build_info.manufacturer_name == String{"Maker"});
    CHECK(data->build_info.product_name == String{"Busbar"});
    CHECK(status.source_timestamp == fixture.wall_clock.time);

    CHECK(read(client, id::Server_ServerStatus_CurrentTime).value ==
          Variant{fixture.wall_clock.time});
    CHECK(read(client, id::Server_ServerArray).value ==
          Variant{Array<String>{"urn:busbar:test:server"}});
    CHECK(read(client, id::Server_NamespaceArray).value ==
          Variant{Array<String>{"http://opcfoundation.org/UA/", "urn:busbar:test:server"}});
    CHECK(read(client, id::Server_ServiceLevel).value == Variant{std::uint8_t{255}});
    CHECK(read(client, id::Server_Auditing).value == Variant{false});
    CHECK(read(client, id::Server_ServerRedundancy_RedundancySupport).value ==
          Variant{std::int32_t{0}});
    CHECK(read(client, id::Server_ServerCapabilities_LocaleIdArray).value ==
          Variant{Array<String>{"en"}});
    CHECK(read(client, id::Server_ServerCapabilities_MaxSessions).value ==
          Variant{std::uint32_t{100}});
    CHECK(read(client, id::Server_ServerCapabilities_OperationLimits_MaxNodesPerRead).value ==
          Variant{std::uint32_t{12}});
}

TEST_CASE("the capabilities are the limits of the server",
          "[unit:Base Info Events Capabilities][unit:Base Info Method Capabilities]"
          "[unit:Base Info Node Management Capabilities]"
          "[unit:Base Info Server Capabilities]"
          "[unit:Base Info Server Capabilities 2]"
          "[unit:Base Info Server Capabilities MaxMonitoredItemsQueueSize]"
          "[unit:Base Info Server Capabilities Subscriptions]")
{
    auto config = ServerFixture::insecure_config();
    auto& limits = config.limits;
    limits.max_browse_continuation_points = 7;
    limits.events.filter.max_select_clauses = 31;
    limits.events.filter.max_elements = 32;
    limits.operations.max_nodes_per_method_call = 33;
    limits.operations.max_nodes_per_node_management = 34;
    limits.subscriptions.max_items = 35;
    limits.subscriptions.max_items_per_subscription = 36;
    limits.subscriptions.max_queue_size = 37;
    limits.subscriptions.max_subscriptions = 38;
    limits.subscriptions.max_subscriptions_per_session = 39;
    ServerFixture fixture{std::move(config)};
    auto client = fixture.log_in();
    CHECK(read(client, id::Server_ServerCapabilities_MaxBrowseContinuationPoints).value ==
          Variant{std::uint16_t{7}});
    const std::pair<std::uint32_t, std::uint32_t> rows[] = {
        {id::Server_ServerCapabilities_MaxSelectClauseParameters, 31},
        {id::Server_ServerCapabilities_MaxWhereClauseParameters, 32},
        {id::Server_ServerCapabilities_OperationLimits_MaxNodesPerMethodCall, 33},
        {id::Server_ServerCapabilities_OperationLimits_MaxNodesPerNodeManagement, 34},
        {id::Server_ServerCapabilities_MaxMonitoredItems, 35},
        {id::Server_ServerCapabilities_MaxMonitoredItemsPerSubscription, 36},
        {id::Server_ServerCapabilities_MaxMonitoredItemsQueueSize, 37},
        {id::Server_ServerCapabilities_MaxSubscriptions, 38},
        {id::Server_ServerCapabilities_MaxSubscriptionsPerSession, 39},
    };
    for (const auto& [node, value] : rows) {
        INFO("i=" << node);
        // A small namespace 0 has fewer.
        const bool is_there = fixture.server.address_space().find(node) != model::no_node;
        CHECK((!is_there || read(client, node).value == Variant{value}));
    }
}

TEST_CASE("a server claims what it is configured for")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    const server::Conformance& conformance = fixture.server.conformance();
    const auto uris = read(client, id::Server_ServerCapabilities_ServerProfileArray).value;
    const auto units = read(client, id::Server_ServerCapabilities_ConformanceUnits).value;
    REQUIRE(uris.array_if<String>() != nullptr);
    REQUIRE(units.array_if<QualifiedName>() != nullptr);
    REQUIRE(units.array_if<QualifiedName>()->size() == conformance.units.size());
    CHECK((*units.array_if<QualifiedName>())[0] == QualifiedName{0, String{conformance.units[0]}});
    std::size_t claimed = 0;
    for (const server::ProfileAssessment& profile : conformance.profiles) {
        const auto& told = *uris.array_if<String>();
        const bool is_told = std::find(told.begin(), told.end(), String{profile.uri}) != told.end();
        INFO(profile.name);
        CHECK(is_told == (profile.is_claimed && !profile.is_client));
        claimed += is_told ? 1 : 0;
    }
    CHECK(uris.array_if<String>()->size() == claimed);
    CHECK(conformance.find("TransportUaTcp")->is_claimed);
    CHECK(conformance.find("SecurityPolicyBasic256Sha256")->is_claimed);
    CHECK_FALSE(conformance.find("SecurityPolicyAes128Sha256RsaOaep")->is_claimed);
    CHECK_FALSE(conformance.find("NodeManagement")->is_claimed);
    CHECK(conformance.find("nothing") == nullptr);
}

TEST_CASE("every live value has the type and rank of its node")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    auto& space = fixture.server.address_space();
    int checked = 0;
    for (std::uint32_t node = 2'254; node < 32'000; ++node) {
        const auto index = space.find(node);
        if (index == model::no_node || space.node_class(index) != NodeClass::Variable ||
            (node > 3'000 && node < 11'000)) {
            continue;
        }
        const auto value = read(client, node);
        if (value.value.is_null()) {
            continue;
        }
        ++checked;
        const auto variable = space.variable(index);
        INFO(node);
        CHECK(space.check_value(value.value, variable.data_type, variable.value_rank,
                                variable.array_dimensions) == status::Good);
    }
    CHECK(checked > 35);
}

TEST_CASE("one operation more than MaxNodesPerRead and MaxNodesPerWrite is one too many")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    const auto told = [&](std::uint32_t limit) {
        return read(client, limit).value.value_or<std::uint32_t>(0);
    };
    const std::uint32_t longest = told(id::Server_ServerCapabilities_MaxArrayLength);
    const std::uint32_t reads = told(id::Server_ServerCapabilities_OperationLimits_MaxNodesPerRead);
    REQUIRE(reads > 0);
    REQUIRE(reads < longest);
    ReadRequest request;
    request.nodes_to_read.resize(reads + 1);
    CHECK(client.status_of<ReadResponse>(request) == status::Bad_TooManyOperations);
    const std::uint32_t writes =
        told(id::Server_ServerCapabilities_OperationLimits_MaxNodesPerWrite);
    REQUIRE(writes > 0);
    REQUIRE(writes < longest);
    WriteRequest write;
    write.nodes_to_write.resize(writes + 1);
    for (WriteValue& value : write.nodes_to_write) { // as long as those of clients are
        value.node_id = NodeId{1, "Press 4.Pressure"};
        value.attribute_id = 13;
        value.value = DataValue{Variant{4.5}};
    }
    CHECK(client.status_of<WriteResponse>(write) == status::Bad_TooManyOperations);
}

TEST_CASE("the operation limits that are told are enforced")
{
    auto config = ServerFixture::insecure_config();
    config.limits.operations.max_nodes_per_read = 2;
    ServerFixture fixture{std::move(config)};
    auto client = fixture.log_in();
    ReadRequest request;
    request.nodes_to_read.resize(3);
    CHECK(client.status_of<ReadResponse>(request) == status::Bad_TooManyOperations);
    request.nodes_to_read.resize(2);
    CHECK(client.status_of<ReadResponse>(request) == status::Good);
}

} // namespace server_object_test

#pragma once

#include <catch2/catch.hpp>

#include <vector>

#include <busbar/types/attribute.hpp>
#include <busbar/types/view.hpp>

#include "subscription_fixture.hpp"

namespace busbar::test {

/// Clients that look at the server's diagnostics.
struct DiagnosticsFixture : SubscriptionFixture {
    using SubscriptionFixture::SubscriptionFixture;

    static DataValue read(TestClient& client, std::uint32_t node)
    {
        return read(client, NodeId{0, node});
    }
    static DataValue read(TestClient& client, const NodeId& node)
    {
        ReadRequest request;
        request.timestamps_to_return = TimestampsToReturn::Neither;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = node;
        request.nodes_to_read[0].attribute_id = 13;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    static std::uint32_t number(TestClient& client, std::uint32_t node)
    {
        const DataValue value = read(client, node);
        CHECK(value.status == status::Good);
        return value.value.value_or<std::uint32_t>(UINT32_MAX);
    }
    template <typename T>
    static std::vector<T> array(TestClient& client, std::uint32_t node)
    {
        std::vector<T> all;
        const DataValue value = read(client, node);
        CHECK(value.status == status::Good);
        const auto* objects = value.value.array_if<ExtensionObject>();
        REQUIRE(objects != nullptr);
        for (const ExtensionObject& object : *objects) {
            REQUIRE(object.get_if<T>() != nullptr);
            all.push_back(*object.get_if<T>());
        }
        return all;
    }
    static std::vector<ReferenceDescription> children(TestClient& client, const NodeId& node)
    {
        BrowseRequest request;
        request.nodes_to_browse.resize(1);
        request.nodes_to_browse[0].node_id = node;
        request.nodes_to_browse[0].browse_direction = BrowseDirection::Forward;
        request.nodes_to_browse[0].reference_type_id = NodeId{0, id::HasComponent};
        request.nodes_to_browse[0].include_subtypes = true;
        request.nodes_to_browse[0].result_mask = 0x3F;
        const auto response = client.call<BrowseResponse>(request);
        REQUIRE(response);
        const auto& references = response->results[0].references;
        return {references.begin(), references.end()};
    }
    static std::vector<ReferenceDescription> session_objects(TestClient& client)
    {
        auto all =
            children(client, NodeId{0, id::Server_ServerDiagnostics_SessionsDiagnosticsSummary});
        std::erase_if(all, [](const ReferenceDescription& child) {
            return child.node_class != NodeClass::Object;
        });
        return all;
    }
    static StatusCode enable(TestClient& client, bool flag)
    {
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = NodeId{0, id::Server_ServerDiagnostics_EnabledFlag};
        request.nodes_to_write[0].attribute_id = 13;
        request.nodes_to_write[0].value = DataValue{Variant{flag}};
        const auto response = client.call<WriteResponse>(request);
        return response ? response->results[0] : response.error();
    }
    /// With the roles ConfigureAdmin and SecurityAdmin.
    [[nodiscard]] TestClient log_in_admin() { return log_in_as("admin"); }
};

} // namespace busbar::test

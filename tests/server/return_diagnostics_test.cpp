#include <catch2/catch.hpp>

#include <busbar/types/attribute.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/node_management.hpp>
#include <busbar/types/query.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/view.hpp>

#include "server/session/return_diagnostics.hpp"
#include "subscription_fixture.hpp"

namespace return_diagnostics_test {

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr std::uint32_t all_bits = 0x3FF;
constexpr std::uint32_t symbolic_ids = 0x21;

/// A response of any service, as far as its diagnostics go.
struct Told {
    ResponseHeader header;
    std::vector<Array<DiagnosticInfo>> operations;

    [[nodiscard]] std::string text(std::optional<std::int32_t> index) const
    {
        const bool is_there =
            index && *index >= 0 && static_cast<std::size_t>(*index) < header.string_table.size();
        return is_there ? header.string_table[static_cast<std::size_t>(*index)].str() : "?";
    }
};

/// Clients that ask what went wrong.
struct DiagnosticsOfRequests : SubscriptionFixture {
    template <typename Response, typename Request>
    static Response ask(TestClient& client, Request request, std::uint32_t bits = all_bits)
    {
        request.request_header.return_diagnostics = bits;
        const auto response = client.call<Response>(std::move(request));
        INFO((response ? "" : std::string{name(response.error())}));
        REQUIRE(response);
        return *response;
    }
    /// Every operation of the request fails.
    template <typename Response, typename Request>
    static void check_all(TestClient& client, Request request, StatusCode expected)
    {
        const Response response = ask<Response>(client, std::move(request));
        const Told told{response.response_header, {}};
        REQUIRE(response.diagnostic_infos.size() == response.results.size());
        REQUIRE_FALSE(response.results.empty());
        for (const DiagnosticInfo& info : response.diagnostic_infos) {
            CHECK(told.text(info.symbolic_id) == name(expected));
            CHECK(told.text(info.namespace_uri) == "http://opcfoundation.org/UA/");
            CHECK(told.text(info.locale) == "en");
            CHECK(told.text(info.localized_text).find('_') == std::string::npos);
            CHECK_FALSE(info.inner_status_code);
        }
        CHECK(response.response_header.string_table.size() == 4); // each once
        CHECK(response.response_header.service_diagnostics.is_null());
    }
    static ReadRequest read_of(std::initializer_list<NodeId> nodes)
    {
        ReadRequest request;
        for (const NodeId& node : nodes) {
            request.nodes_to_read.push_back({node, 13, {}, {}});
        }
        return request;
    }

    TestClient admin{log_in_as("admin")};
    TestClient client{log_in_as("operator")};
    const NodeId nowhere{1, "nowhere"};
};

} // namespace

TEST_CASE_METHOD(DiagnosticsOfRequests, "diagnostics only for who asks, where something is wrong",
                 "[unit:Base Services Diagnostics]")
{
    const NodeId state{0, id::Server_ServerStatus_State};
    auto response = ask<ReadResponse>(client, read_of({state, nowhere, state, nowhere}), 0);
    CHECK(response.diagnostic_infos.empty());
    CHECK(response.response_header.string_table.empty());
    response = ask<ReadResponse>(client, read_of({state, state}));
    CHECK(response.diagnostic_infos.empty());
    CHECK(response.response_header.string_table.empty());

    response = ask<ReadResponse>(client, read_of({state, nowhere, state, nowhere}), symbolic_ids);
    const Told told{response.response_header, {}};
    REQUIRE(response.diagnostic_infos.size() == 4);
    CHECK(response.diagnostic_infos[0].is_null());
    CHECK(response.diagnostic_infos[2].is_null());
    CHECK(told.text(response.diagnostic_infos[1].symbolic_id) == "Bad_NodeIdUnknown");
    CHECK(response.diagnostic_infos[1] == response.diagnostic_infos[3]);
    CHECK_FALSE(response.diagnostic_infos[1].localized_text);
    CHECK_FALSE(response.diagnostic_infos[1].additional_info);
    CHECK(response.response_header.string_table.size() == 2);
}

TEST_CASE_METHOD(DiagnosticsOfRequests, "only administrators get additional information")
{
    const auto info_of = [&](TestClient& asker) {
        return ask<ReadResponse>(asker, read_of({nowhere})).diagnostic_infos.front();
    };
    REQUIRE(info_of(admin).additional_info);
    CHECK(info_of(admin).additional_info->view() == "ns=1;s=nowhere, attribute 13");
    CHECK(info_of(client).symbolic_id);
    CHECK_FALSE(info_of(client).additional_info);
}

TEST_CASE("additional information is bounded, however much there is")
{
    using server::detail::ReturnDiagnostics;
    ReturnDiagnostics diagnostics{all_bits};
    const auto infos = diagnostics.of_operations(
        10'000, [](std::size_t) { return StatusCode{status::Bad_NodeIdUnknown}; },
        [](std::size_t) { return std::string(1'000, 'x'); });
    REQUIRE(infos.size() == 10'000);
    std::size_t bytes = 0;
    for (const DiagnosticInfo& info : infos) {
        bytes += info.additional_info ? info.additional_info->size() : 0;
    }
    CHECK(bytes > ReturnDiagnostics::max_additional_info / 2);
    CHECK(bytes <= ReturnDiagnostics::max_additional_info);
    CHECK(infos[0].additional_info->size() == 256);
    CHECK(infos[9'999].symbolic_id == infos[0].symbolic_id);
    CHECK(diagnostics.string_table().size() == 4);
}

TEST_CASE("the text of a StatusCode is its name in words")
{
    using server::detail::ReturnDiagnostics;
    const auto words = [](StatusCode status) {
        ReturnDiagnostics diagnostics{all_bits};
        const DiagnosticInfo info = diagnostics.of_service(status);
        return Told{{.string_table = diagnostics.string_table()}, {}}.text(info.localized_text);
    };
    CHECK(words(status::Bad_UserAccessDenied) == "User Access Denied");
    CHECK(words(status::Bad_NodeIdUnknown) == "Node Id Unknown");
    CHECK(words(status::Bad_TooManySessions) == "Too Many Sessions");
    CHECK(words(status::Bad_TypeDefinitionInvalid) == "Type Definition Invalid");
    CHECK(words(status::Bad_NoEntryExists) == "No Entry Exists");
}

TEST_CASE_METHOD(DiagnosticsOfRequests, "every service tells of its operations")
{
    check_all<ReadResponse>(client, read_of({nowhere, nowhere}), status::Bad_NodeIdUnknown);
    WriteRequest write;
    write.nodes_to_write.push_back({nowhere, 13, {}, {}});
    check_all<WriteResponse>(client, write, status::Bad_NodeIdUnknown);
    BrowseRequest browse;
    browse.nodes_to_browse.resize(2);
    browse.nodes_to_browse[0].node_id = browse.nodes_to_browse[1].node_id = nowhere;
    check_all<BrowseResponse>(client, browse, status::Bad_NodeIdUnknown);
    BrowseNextRequest next;
    next.continuation_points.resize(1);
    check_all<BrowseNextResponse>(client, next, status::Bad_ContinuationPointInvalid);
    TranslateBrowsePathsToNodeIdsRequest translate;
    translate.browse_paths.resize(1);
    translate.browse_paths[0].starting_node = nowhere;
    translate.browse_paths[0].relative_path.elements.resize(1);
    translate.browse_paths[0].relative_path.elements[0].target_name = {0, "x"};
    check_all<TranslateBrowsePathsToNodeIdsResponse>(client, translate, status::Bad_NodeIdUnknown);
    CallRequest call;
    call.methods_to_call.resize(1);
    call.methods_to_call[0].object_id = nowhere;
    call.methods_to_call[0].method_id = nowhere;
    check_all<CallResponse>(client, call, status::Bad_NodeIdUnknown);

    const std::uint32_t subscription = subscribe(client);
    CreateMonitoredItemsRequest create;
    create.subscription_id = subscription;
    create.items_to_create = {item_request(nowhere)};
    check_all<CreateMonitoredItemsResponse>(client, create, status::Bad_NodeIdUnknown);
    ModifyMonitoredItemsRequest modify;
    modify.subscription_id = subscription;
    modify.items_to_modify.resize(1);
    check_all<ModifyMonitoredItemsResponse>(client, modify, status::Bad_MonitoredItemIdInvalid);
    SetMonitoringModeRequest mode;
    mode.subscription_id = subscription;
    mode.monitored_item_ids = {9};
    check_all<SetMonitoringModeResponse>(client, mode, status::Bad_MonitoredItemIdInvalid);
    DeleteMonitoredItemsRequest remove;
    remove.subscription_id = subscription;
    remove.monitored_item_ids = {9};
    check_all<DeleteMonitoredItemsResponse>(client, remove, status::Bad_MonitoredItemIdInvalid);
    SetPublishingModeRequest publishing;
    publishing.subscription_ids = {subscription + 1};
    check_all<SetPublishingModeResponse>(client, publishing, status::Bad_SubscriptionIdInvalid);
    TransferSubscriptionsRequest take_over;
    take_over.subscription_ids = {subscription + 1};
    check_all<TransferSubscriptionsResponse>(client, take_over, status::Bad_SubscriptionIdInvalid);
    DeleteSubscriptionsRequest end;
    end.subscription_ids = {subscription + 1};
    check_all<DeleteSubscriptionsResponse>(client, end, status::Bad_SubscriptionIdInvalid);
}

TEST_CASE("NodeManagement tells of its operations")
{
    using Requests = DiagnosticsOfRequests;
    server::ServerConfig config = ServerFixture::insecure_config();
    config.has_node_management = true;
    ServerFixture fixture{std::move(config)};
    TestClient admin = fixture.log_in_as("admin");
    const NodeId nowhere{1, "nowhere"};
    AddNodesRequest add;
    add.nodes_to_add.resize(1);
    add.nodes_to_add[0].parent_node_id.node_id = nowhere;
    Requests::check_all<AddNodesResponse>(admin, add, status::Bad_ParentNodeIdInvalid);
    AddReferencesRequest refer;
    refer.references_to_add.resize(1);
    refer.references_to_add[0].source_node_id = nowhere;
    Requests::check_all<AddReferencesResponse>(admin, refer, status::Bad_SourceNodeIdInvalid);
    DeleteReferencesRequest unrefer;
    unrefer.references_to_delete.resize(1);
    unrefer.references_to_delete[0].source_node_id = nowhere;
    Requests::check_all<DeleteReferencesResponse>(admin, unrefer, status::Bad_SourceNodeIdInvalid);
    DeleteNodesRequest delete_nodes;
    delete_nodes.nodes_to_delete.resize(1);
    delete_nodes.nodes_to_delete[0].node_id = nowhere;
    Requests::check_all<DeleteNodesResponse>(admin, delete_nodes, status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(DiagnosticsOfRequests, "acknowledgements and links have diagnostics, too")
{
    const std::uint32_t subscription = subscribe(client);
    PublishRequest publish_request;
    publish_request.request_header.return_diagnostics = all_bits;
    publish_request.subscription_acknowledgements = {{subscription, 77}, {subscription + 1, 1}};
    const std::uint32_t sent = client.send(publish_request);
    advance(std::chrono::milliseconds{100});
    const auto published = take(client, sent);
    REQUIRE(published);
    const Told told{published->response_header, {}};
    REQUIRE(published->diagnostic_infos.size() == 2);
    CHECK(told.text(published->diagnostic_infos[0].symbolic_id) == "Bad_SequenceNumberUnknown");
    CHECK(told.text(published->diagnostic_infos[1].symbolic_id) == "Bad_SubscriptionIdInvalid");

    const auto node = add_variable("level", 1);
    const auto item = monitor(client, subscription, item_request(node));
    SetTriggeringRequest links;
    links.subscription_id = subscription;
    links.triggering_item_id = item.monitored_item_id;
    links.links_to_add = {98};
    links.links_to_remove = {99, 100};
    const auto triggered = ask<SetTriggeringResponse>(client, links, symbolic_ids);
    const Told of_links{triggered.response_header, {}};
    REQUIRE(triggered.add_diagnostic_infos.size() == 1);
    REQUIRE(triggered.remove_diagnostic_infos.size() == 2);
    CHECK(of_links.text(triggered.remove_diagnostic_infos[1].symbolic_id) ==
          "Bad_MonitoredItemIdInvalid");
}

TEST_CASE_METHOD(DiagnosticsOfRequests, "a ServiceFault says what it is about")
{
    const auto fault_of = [&](TestClient& asker, auto request, std::uint32_t bits) {
        request.request_header.return_diagnostics = bits;
        request.request_header.authentication_token = asker.authentication_token;
        const std::uint32_t id = asker.send_bytes([&](binary::Writer& writer) {
            encode(writer, NodeId{0, decltype(request)::binary_encoding_id});
            encode(writer, request);
        });
        REQUIRE_FALSE(asker.messages.empty());
        CHECK(asker.messages.back().request_id == id);
        binary::Reader reader{asker.messages.back().body};
        NodeId type;
        decode(reader, type);
        CHECK(type == NodeId{0, ServiceFault::binary_encoding_id});
        ResponseHeader header;
        decode(reader, header);
        CHECK(reader.ok());
        asker.messages.clear();
        return Told{header, {}};
    };
    const Told nothing = fault_of(client, ReadRequest{}, 0x3E0);
    CHECK(nothing.header.service_result == status::Bad_NothingToDo);
    CHECK(nothing.header.service_diagnostics.is_null());
    CHECK(nothing.header.string_table.empty());
    const Told all = fault_of(client, ReadRequest{}, all_bits);
    CHECK(all.text(all.header.service_diagnostics.symbolic_id) == "Bad_NothingToDo");
    CHECK(all.text(all.header.service_diagnostics.localized_text) == "Nothing To Do");
    // Also of a service that is a function, of one that is not there, and without a session.
    const Told function = fault_of(client, SetPublishingModeRequest{}, all_bits);
    CHECK(function.text(function.header.service_diagnostics.symbolic_id) == "Bad_NothingToDo");
    const Told absent = fault_of(client, QueryFirstRequest{}, all_bits);
    CHECK(absent.text(absent.header.service_diagnostics.symbolic_id) == "Bad_ServiceUnsupported");
    TestClient stranger = connect();
    const Told unknown = fault_of(stranger, ReadRequest{}, all_bits);
    CHECK(unknown.text(unknown.header.service_diagnostics.symbolic_id) == "Bad_SessionIdInvalid");
}

} // namespace return_diagnostics_test

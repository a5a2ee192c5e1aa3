#include <catch2/catch.hpp>

#include <array>
#include <string>
#include <vector>

#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "management_fixture.hpp"
#include "method_fixture.hpp"
#include "session_use.hpp"

namespace operation_attack_test {

// Requests with no operation, with one too many, and with one that is not the user's among others
// that are (tests/attacks.txt, E).

using namespace busbar;
using namespace busbar::test;

namespace {

/// A server that takes two operations in a request.
struct TwoAtOnce : Outside, ServerFixture {
    TwoAtOnce() : ServerFixture{no_waker, config(), &rights}, client{log_in_manager()} {}

    [[nodiscard]] static server::ServerConfig config()
    {
        server::ServerConfig config = insecure_config();
        config.has_node_management = true;
        config.limits.operations = {2, 2, 2, 2, 2, 2, 2, 2};
        return config;
    }
    [[nodiscard]] TestClient log_in_manager()
    {
        users.everybody.roles = {"ConfigureAdmin"};
        users.everybody.access_level_mask = 0xFF;
        return log_in();
    }
    /// A request with none, with three and with two operations.
    template <typename Response, typename Request, typename Operations>
    void check_count(Operations Request::*operations, Request request = {})
    {
        INFO(Request::binary_encoding_id);
        CHECK(client.status_of<Response>(request) == status::Bad_NothingToDo);
        (request.*operations).resize(3);
        CHECK(client.status_of<Response>(request) == status::Bad_TooManyOperations);
        (request.*operations).resize(2);
        CHECK(client.status_of<Response>(request) == status::Good);
    }

    TestClient client;
};

template <typename Request>
Request of_subscription(std::uint32_t id)
{
    Request request;
    request.subscription_id = id;
    return request;
}

/// Hides one node, and lets nobody read, write or call another.
class SideDoors final : public server::AccessControl {
public:
    [[nodiscard]] bool may_browse(const server::UserIdentity&, const NodeId& node) const override
    {
        return node != hidden;
    }
    [[nodiscard]] std::uint8_t user_access_level(const server::UserIdentity&, const NodeId& node,
                                                 std::uint8_t access_level) const override
    {
        return node == denied ? 0 : access_level;
    }
    [[nodiscard]] bool may_call(const server::UserIdentity&, const NodeId& method) const override
    {
        return method != denied_method;
    }

    NodeId hidden{1, "Hidden"};
    NodeId denied{1, "Denied"};
    NodeId denied_method{1, "DeniedMethod"};
};

struct Doors {
    SideDoors doors;
};

/// Three Variables of which a user has the first and the last only.
struct Batch : Doors, MethodFixture {
    Batch() : MethodFixture{insecure_config(), &doors}
    {
        for (const char* name : names) {
            model::NewVariable variable;
            variable.data_type = NodeId{0, id::Int32};
            variable.access_level = model::Access::ReadWrite;
            variable.value = Variant{std::int32_t{1}};
            REQUIRE(space().add_variable(named(name, space().find(id::ObjectsFolder)), variable));
        }
    }

    static constexpr std::array names{"First", "Denied", "Hidden", "Last"};
    TestClient client{log_in()};
};

} // namespace

TEST_CASE_METHOD(TwoAtOnce, "every service with operations refuses none and one too many",
                 "[attack]")
{
    check_count<ReadResponse>(&ReadRequest::nodes_to_read);
    check_count<WriteResponse>(&WriteRequest::nodes_to_write);
    check_count<BrowseResponse>(&BrowseRequest::nodes_to_browse);
    check_count<BrowseNextResponse>(&BrowseNextRequest::continuation_points);
    check_count<TranslateBrowsePathsToNodeIdsResponse>(
        &TranslateBrowsePathsToNodeIdsRequest::browse_paths);
    check_count<CallResponse>(&CallRequest::methods_to_call);
    check_count<AddNodesResponse>(&AddNodesRequest::nodes_to_add);
    check_count<AddReferencesResponse>(&AddReferencesRequest::references_to_add);
    check_count<DeleteNodesResponse>(&DeleteNodesRequest::nodes_to_delete);
    check_count<DeleteReferencesResponse>(&DeleteReferencesRequest::references_to_delete);
    check_count<SetPublishingModeResponse>(&SetPublishingModeRequest::subscription_ids);
    check_count<TransferSubscriptionsResponse>(&TransferSubscriptionsRequest::subscription_ids);
    check_count<DeleteSubscriptionsResponse>(&DeleteSubscriptionsRequest::subscription_ids);

    const auto made = client.call<CreateSubscriptionResponse>(CreateSubscriptionRequest{});
    REQUIRE(made);
    const std::uint32_t own = made->subscription_id;
    check_count<CreateMonitoredItemsResponse>(&CreateMonitoredItemsRequest::items_to_create,
                                              of_subscription<CreateMonitoredItemsRequest>(own));
    check_count<ModifyMonitoredItemsResponse>(&ModifyMonitoredItemsRequest::items_to_modify,
                                              of_subscription<ModifyMonitoredItemsRequest>(own));
    check_count<SetMonitoringModeResponse>(&SetMonitoringModeRequest::monitored_item_ids,
                                           of_subscription<SetMonitoringModeRequest>(own));
    check_count<DeleteMonitoredItemsResponse>(&DeleteMonitoredItemsRequest::monitored_item_ids,
                                              of_subscription<DeleteMonitoredItemsRequest>(own));
    auto triggering = of_subscription<SetTriggeringRequest>(own);
    CHECK(client.status_of<SetTriggeringResponse>(triggering) == status::Bad_NothingToDo);
    triggering.links_to_add.resize(2);
    triggering.links_to_remove.resize(1); // both count together
    CHECK(client.status_of<SetTriggeringResponse>(triggering) == status::Bad_TooManyOperations);
    RegisterNodesRequest nodes;
    CHECK(client.status_of<RegisterNodesResponse>(nodes) == status::Bad_NothingToDo);
    nodes.nodes_to_register.resize(3);
    CHECK(client.status_of<RegisterNodesResponse>(nodes) == status::Bad_TooManyOperations);
    UnregisterNodesRequest registered;
    CHECK(client.status_of<UnregisterNodesResponse>(registered) == status::Bad_NothingToDo);
    registered.nodes_to_unregister.resize(3);
    CHECK(client.status_of<UnregisterNodesResponse>(registered) == status::Bad_TooManyOperations);
    PublishRequest publish;
    publish.subscription_acknowledgements.resize(10'001);
    CHECK(client.status_of<PublishResponse>(publish) == status::Bad_TooManyOperations);
}

TEST_CASE_METHOD(TwoAtOnce, "of one operation too many none is carried out", "[attack]")
{
    const std::size_t nodes = server.address_space().node_count();
    AddNodesRequest request;
    request.nodes_to_add.resize(3);
    std::uint32_t number = 0;
    for (AddNodesItem& item : request.nodes_to_add) {
        item.parent_node_id = NodeId{0, id::ObjectsFolder};
        item.reference_type_id = NodeId{0, id::Organizes};
        item.requested_new_node_id = NodeId{1, ++number};
        item.browse_name = QualifiedName{1, String{std::to_string(number)}};
        item.node_class = NodeClass::Object;
        item.type_definition = NodeId{0, id::FolderType};
    }
    CHECK(client.status_of<AddNodesResponse>(request) == status::Bad_TooManyOperations);
    CHECK(server.address_space().node_count() == nodes);
    request.nodes_to_add.resize(2);
    const auto added = client.call<AddNodesResponse>(request);
    REQUIRE(added);
    CHECK(added->results[1].status_code == status::Good);
    CHECK(server.address_space().node_count() > nodes);
}

TEST_CASE_METHOD(Batch, "a node that is not for the user is refused among others that are",
                 "[attack]")
{
    const std::vector<StatusCode> expected{status::Good, status::Bad_UserAccessDenied,
                                           status::Bad_NodeIdUnknown, status::Good};
    ReadRequest read;
    WriteRequest write;
    BrowseRequest browse;
    CreateMonitoredItemsRequest monitor;
    CreateSubscriptionRequest subscription;
    subscription.publishing_enabled = true;
    subscription.requested_publishing_interval = 1'000;
    subscription.requested_lifetime_count = 30;
    subscription.requested_max_keep_alive_count = 3;
    monitor.subscription_id =
        client.call<CreateSubscriptionResponse>(subscription).value().subscription_id;
    for (const char* name : names) {
        auto& to_read = read.nodes_to_read.emplace_back();
        to_read.node_id = own(name);
        to_read.attribute_id = 13;
        auto& to_write = write.nodes_to_write.emplace_back();
        to_write.node_id = own(name);
        to_write.attribute_id = 13;
        to_write.value = DataValue{Variant{std::int32_t{2}}};
        browse.nodes_to_browse.emplace_back().node_id = own(name);
        auto& item = monitor.items_to_create.emplace_back();
        item.item_to_monitor.node_id = own(name);
        item.item_to_monitor.attribute_id = 13;
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.queue_size = 1;
    }
    const auto browsed = client.call<BrowseResponse>(browse);
    const auto was_read = client.call<ReadResponse>(read);
    const auto written = client.call<WriteResponse>(write);
    const auto monitored = client.call<CreateMonitoredItemsResponse>(monitor);
    REQUIRE((was_read && written && browsed && monitored));
    for (std::size_t i = 0; i < names.size(); ++i) {
        INFO(names[i]);
        CHECK(was_read->results[i].status == expected[i]);
        CHECK(written->results[i] == expected[i]);
        CHECK(browsed->results[i].status_code ==
              (i == 2 ? StatusCode{status::Bad_NodeIdUnknown} : StatusCode{}));
        // What may not be read may be monitored, and its value tells so (Part 4, 5.13.1.2).
        CHECK(monitored->results[i].status_code ==
              (i == 2 ? StatusCode{status::Bad_NodeIdUnknown} : StatusCode{}));
    }
    const auto publish = client.send(PublishRequest{});
    advance(std::chrono::seconds{1}, client);
    const auto told = client.take<PublishResponse>(publish);
    REQUIRE(told);
    REQUIRE(told->notification_message.notification_data.size() == 1);
    const auto* changes =
        told->notification_message.notification_data[0].get_if<DataChangeNotification>();
    REQUIRE(changes != nullptr);
    REQUIRE(changes->monitored_items.size() == 3);
    CHECK(changes->monitored_items[1].value.status == status::Bad_UserAccessDenied);
    CHECK(changes->monitored_items[1].value.value.is_null());
    // Nobody finds the hidden one by its name either.
    TranslateBrowsePathsToNodeIdsRequest translate;
    for (const char* name : names) {
        BrowsePath& path = translate.browse_paths.emplace_back();
        path.starting_node = NodeId{0, id::ObjectsFolder};
        path.relative_path.elements.resize(1);
        path.relative_path.elements[0].target_name = QualifiedName{1, name};
    }
    const auto paths = client.call<TranslateBrowsePathsToNodeIdsResponse>(translate);
    REQUIRE(paths);
    CHECK(paths->results[0].status_code == status::Good);
    CHECK(paths->results[2].status_code == status::Bad_NoMatch);
    CHECK(paths->results[3].status_code == status::Good);
}

TEST_CASE_METHOD(Batch, "a Method that is not for the user is not called among others that are",
                 "[attack]")
{
    int entered = 0;
    add("DeniedMethod", {}, {}, [&](server::MethodCall call) {
        ++entered;
        call.succeed();
    });
    const NodeId sum = add_sum();
    const auto good = to_call(sum, {Variant{1}, Variant{2}});
    const auto both = client.call<CallResponse>(
        request({good, to_call(own("DeniedMethod")), to_call(own("Hidden")), good}));
    REQUIRE(both);
    CHECK(both->results[0].status_code == status::Good);
    CHECK(both->results[1].status_code == status::Bad_UserAccessDenied);
    CHECK(both->results[2].status_code.is_bad());
    CHECK(both->results[3].output_arguments[0] == Variant{3});
    CHECK(entered == 0);
}

} // namespace operation_attack_test

#include <catch2/catch.hpp>

#include <busbar/server/method_table.hpp>
#include <busbar/server/namespace_metadata.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/node_management.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "server/rights/node_rights.hpp"
#include "session_use.hpp"

namespace node_access_test {

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr std::uint16_t signing = 1;
constexpr std::uint16_t encryption = 2;
constexpr std::uint16_t to_browse = 8;
constexpr auto weak = status::Bad_SecurityModeInsufficient;

server::ServerConfig config_with_management()
{
    server::ServerConfig config = ServerFixture::insecure_config();
    config.has_node_management = true;
    return config;
}

struct Table {
    server::MethodTable methods;
};

/// A folder "Area" with a Variable "Value" and a Method "Go", and clients over each kind of
/// channel.
struct AccessFixture : Table, ServerFixture {
    AccessFixture() : ServerFixture{config_with_management()}
    {
        users.everybody.access_level_mask = 0xFF;
        area = space().add_folder(named("Area", space().find(id::ObjectsFolder))).value();
        model::NewVariable variable;
        variable.access_level = model::Access::ReadWrite;
        variable.data_type = NodeId{0, id::Int32};
        variable.value = std::int32_t{7};
        value = space().add_variable(named("Value", area), variable).value();
        model::NewMethod method;
        method.source = server.add_source(methods);
        method.handle = methods.add([](server::MethodCall call) { call.succeed({}); });
        go = space().add_method(named("Go", area), method).value();
    }
    [[nodiscard]] model::AddressSpace& space() { return server.address_space(); }
    [[nodiscard]] static model::NewNode named(const char* name, model::NodeIndex parent)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = parent;
        return node;
    }
    void restrict_to(model::NodeIndex node, std::uint16_t restrictions)
    {
        model::NodeAccess access;
        access.restrictions = restrictions;
        space().set_node_access(node, access);
    }
    void permit(model::NodeIndex node, std::initializer_list<RolePermissionType> permissions)
    {
        model::NodeAccess access;
        access.role_permissions = Array<RolePermissionType>(permissions);
        space().set_node_access(node, access);
    }
    [[nodiscard]] static DataValue read(TestClient& client, const char* name,
                                        AttributeId attribute = AttributeId::Value)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = NodeId{1, name};
        request.nodes_to_read[0].attribute_id = static_cast<std::uint32_t>(attribute);
        auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] static StatusCode write(TestClient& client, const char* name)
    {
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = NodeId{1, name};
        request.nodes_to_write[0].attribute_id = 13;
        request.nodes_to_write[0].value = DataValue{Variant{std::int32_t{8}}};
        const auto response = client.call<WriteResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] static StatusCode call(TestClient& client)
    {
        CallRequest request;
        request.methods_to_call.resize(1);
        request.methods_to_call[0].object_id = NodeId{1, "Area"};
        request.methods_to_call[0].method_id = NodeId{1, "Go"};
        const auto response = client.call<CallResponse>(request);
        REQUIRE(response);
        return response->results[0].status_code;
    }
    [[nodiscard]] static BrowseResult browse(TestClient& client, const char* name)
    {
        BrowseRequest request;
        request.nodes_to_browse.resize(1);
        request.nodes_to_browse[0].node_id = NodeId{1, name};
        request.nodes_to_browse[0].browse_direction = BrowseDirection::Forward;
        request.nodes_to_browse[0].reference_type_id = NodeId{0, id::HierarchicalReferences};
        request.nodes_to_browse[0].include_subtypes = true;
        auto response = client.call<BrowseResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] static StatusCode translate(TestClient& client)
    {
        TranslateBrowsePathsToNodeIdsRequest request;
        request.browse_paths.resize(1);
        request.browse_paths[0].starting_node = NodeId{1, "Area"};
        RelativePathElement& element =
            request.browse_paths[0].relative_path.elements.emplace_back();
        element.reference_type_id = NodeId{0, id::HierarchicalReferences};
        element.include_subtypes = true;
        element.target_name = QualifiedName{1, "Value"};
        const auto response = client.call<TranslateBrowsePathsToNodeIdsResponse>(request);
        REQUIRE(response);
        return response->results[0].status_code;
    }
    [[nodiscard]] static StatusCode remove(TestClient& client, const char* name)
    {
        DeleteNodesRequest request;
        request.nodes_to_delete = {{NodeId{1, name}, true}};
        const auto response = client.call<DeleteNodesResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    /// What a Subscription of the client reports of "Value" first.
    [[nodiscard]] DataValue monitor(TestClient& client)
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
        item.item_to_monitor.node_id = NodeId{1, "Value"};
        item.item_to_monitor.attribute_id = 13;
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.queue_size = 1;
        const auto created = client.call<CreateMonitoredItemsResponse>(items);
        REQUIRE(created);
        if (created->results[0].status_code.is_bad()) {
            return DataValue{created->results[0].status_code};
        }
        const std::uint32_t publish = client.send(PublishRequest{});
        advance(std::chrono::milliseconds{200});
        const auto response = client.take<PublishResponse>(publish);
        REQUIRE(response);
        REQUIRE(response->notification_message.notification_data.size() == 1);
        const auto* const data =
            response->notification_message.notification_data[0].get_if<DataChangeNotification>();
        REQUIRE(data != nullptr);
        return data->monitored_items[0].value;
    }

    model::NodeIndex area;
    model::NodeIndex value;
    model::NodeIndex go;
    TestClient open{log_in()};
    TestClient signed_only{log_in(sign)};
    TestClient encrypted{log_in(encrypt)};
};

/// What the user "operator" and everybody else may do, as bits of PermissionType.
RolePermissionType role(std::uint32_t id, unsigned permissions)
{
    return {NodeId{0, id}, PermissionType{permissions}};
}
constexpr unsigned may_browse = 1;
constexpr unsigned may_read_roles = 2;
constexpr unsigned may_read = 32;
constexpr unsigned may_write = 64;
constexpr unsigned may_call = 4096;

} // namespace

TEST_CASE_METHOD(AccessFixture, "no channel is strong enough for an attribute that is not there")
{
    restrict_to(go, encryption);
    auto client = log_in();
    CHECK(read(client, "Go").status == status::Bad_AttributeIdInvalid);
    CHECK(read(client, "Go", AttributeId::DataType).status == status::Bad_AttributeIdInvalid);
    CHECK(read(client, "Go", static_cast<AttributeId>(99)).status ==
          status::Bad_AttributeIdInvalid);
    CHECK(write(client, "Go") == status::Bad_AttributeIdInvalid);
    CHECK(call(client) == weak);
    restrict_to(value, encryption);
    CHECK(read(client, "Value").status == weak);
    CHECK(read(client, "Value", AttributeId::Executable).status == status::Bad_AttributeIdInvalid);
}

TEST_CASE_METHOD(AccessFixture, "A node that asks for encryption is used over no weaker channel")
{
    restrict_to(value, encryption);
    restrict_to(go, signing);
    for (TestClient* client : {&open, &signed_only}) {
        CHECK(read(*client, "Value").status == weak);
        CHECK(read(*client, "Value").value.is_null());
        CHECK(write(*client, "Value") == weak);
        CHECK(monitor(*client).status == weak);
        CHECK(read(*client, "Value", AttributeId::RolePermissions).status == weak);
        // Browse is not restricted.
        CHECK(read(*client, "Value", AttributeId::BrowseName).status == status::Good);
        CHECK(browse(*client, "Area").references.size() == 2);
        CHECK(translate(*client) == status::Good);
    }
    CHECK(read(encrypted, "Value").value == Variant{std::int32_t{7}});
    CHECK(monitor(encrypted).value == Variant{std::int32_t{7}});
    CHECK(write(encrypted, "Value") == status::Good);
    CHECK(read(encrypted, "Value", AttributeId::AccessRestrictions).value == Variant{encryption});
    CHECK(call(open) == weak);
    CHECK(call(signed_only) == status::Good);
    CHECK(call(encrypted) == status::Good);
    // The Object is used by a Call, too.
    restrict_to(area, encryption);
    CHECK(call(signed_only) == weak);
}

TEST_CASE_METHOD(AccessFixture, "Restrictions hide a node from Browse where they say so")
{
    restrict_to(value, signing | to_browse);
    CHECK(browse(open, "Area").references.size() == 1);
    CHECK(browse(open, "Value").status_code == weak);
    CHECK(translate(open) == status::Bad_NoMatch);
    CHECK(read(open, "Value", AttributeId::BrowseName).status == weak);
    CHECK(browse(signed_only, "Area").references.size() == 2);
    CHECK(translate(signed_only) == status::Good);
    // Those of the namespace count where a node has none of its own.
    space().set_node_access(value, {});
    space().set_namespace_restrictions(1, encryption | to_browse);
    CHECK(browse(signed_only, "Area").status_code == weak);
    CHECK(read(signed_only, "Value").status == weak);
    CHECK(browse(encrypted, "Area").references.size() == 2);
    restrict_to(value, 0);
    CHECK(read(open, "Value").status == status::Good);
}

TEST_CASE_METHOD(AccessFixture, "Restrictions that come later stop what is monitored")
{
    CHECK(monitor(open).value == Variant{std::int32_t{7}});
    restrict_to(value, signing);
    const std::uint32_t publish = open.send(PublishRequest{});
    advance(std::chrono::seconds{2});
    advance(std::chrono::seconds{2});
    const auto response = open.take<PublishResponse>(publish);
    REQUIRE(response);
    REQUIRE(response->notification_message.notification_data.size() == 1);
    const auto* const data =
        response->notification_message.notification_data[0].get_if<DataChangeNotification>();
    REQUIRE(data != nullptr);
    CHECK(data->monitored_items[0].value.status == weak);
}

TEST_CASE_METHOD(AccessFixture, "Nodes are managed over a channel that is strong enough")
{
    users.everybody.roles = {"ConfigureAdmin"};
    TestClient admin = log_in();
    restrict_to(value, signing);
    CHECK(remove(admin, "Value") == weak);
    CHECK(remove(admin, "Area") == weak); // "Value" is below it
    AddNodesRequest request;
    AddNodesItem& item = request.nodes_to_add.emplace_back();
    item.parent_node_id = NodeId{1, "Area"};
    item.reference_type_id = NodeId{0, id::Organizes};
    item.browse_name = QualifiedName{1, "New"};
    item.node_class = NodeClass::Object;
    item.type_definition = NodeId{0, id::FolderType};
    CHECK(admin.call<AddNodesResponse>(request)->results[0].status_code == status::Good);
    restrict_to(area, signing);
    CHECK(admin.call<AddNodesResponse>(request)->results[0].status_code == weak);
    restrict_to(area, 0);
    permit(area, {role(id::WellKnownRole_ConfigureAdmin, may_browse)});
    CHECK(admin.call<AddNodesResponse>(request)->results[0].status_code ==
          status::Bad_UserAccessDenied);
}

TEST_CASE_METHOD(AccessFixture, "RolePermissions of a node bound what users do",
                 "[unit:Security Role Server Authorization]")
{
    permit(value, {role(id::WellKnownRole_Anonymous, may_browse),
                   role(id::WellKnownRole_AuthenticatedUser, may_browse | may_read)});
    permit(go, {role(id::WellKnownRole_AuthenticatedUser, may_browse | may_call)});
    CHECK(read(open, "Value").status == status::Bad_UserAccessDenied);
    CHECK(read(open, "Value", AttributeId::UserAccessLevel).value == Variant{std::uint8_t{0}});
    CHECK(read(encrypted, "Value").status == status::Good);
    CHECK(write(encrypted, "Value") == status::Bad_UserAccessDenied);
    CHECK(read(encrypted, "Value", AttributeId::UserAccessLevel).value == Variant{std::uint8_t{1}});
    CHECK(call(open) == status::Bad_NodeIdUnknown); // he may not know of it
    CHECK(call(encrypted) == status::Good);
    CHECK(browse(open, "Area").references.size() == 1);

    // Roles that the store gave, by the BrowseName of their node, too.
    users.everybody.roles = {"Operator", "Area"};
    TestClient operator_client = log_in();
    permit(value, {role(id::WellKnownRole_Operator, may_browse | may_read),
                   {NodeId{1, "Area"}, PermissionType{may_write}}});
    CHECK(read(operator_client, "Value").status == status::Good);
    CHECK(write(operator_client, "Value") == status::Good);
    CHECK(read(open, "Value").status == status::Bad_NodeIdUnknown);
    // A list without entries gives nobody anything.
    permit(value, {});
    CHECK(read(operator_client, "Value").status == status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(AccessFixture, "RolePermissions are read by whom they let, one's own by everybody")
{
    const auto attribute = [](TestClient& client, AttributeId id) {
        return read(client, "Value", id);
    };
    CHECK(attribute(open, AttributeId::RolePermissions).status == status::Bad_AttributeIdInvalid);
    CHECK(attribute(open, AttributeId::UserRolePermissions).status ==
          status::Bad_AttributeIdInvalid);
    const RolePermissionType everybody = role(id::WellKnownRole_Anonymous, may_browse);
    const RolePermissionType engineer =
        role(id::WellKnownRole_Engineer, may_browse | may_read_roles);
    permit(value, {everybody, engineer});
    CHECK(attribute(open, AttributeId::RolePermissions).status == status::Bad_UserAccessDenied);
    const auto own = attribute(open, AttributeId::UserRolePermissions).value;
    REQUIRE(own.array_if<ExtensionObject>() != nullptr);
    REQUIRE(own.array_if<ExtensionObject>()->size() == 1);
    CHECK(*(*own.array_if<ExtensionObject>())[0].get_if<RolePermissionType>() == everybody);
    for (const char* name : {"Engineer", "ConfigureAdmin", "SecurityAdmin"}) {
        users.everybody.roles = {name};
        TestClient client = log_in();
        const auto all = attribute(client, AttributeId::RolePermissions).value;
        REQUIRE(all.array_if<ExtensionObject>() != nullptr);
        CHECK(all.array_if<ExtensionObject>()->size() == 2);
    }
}

TEST_CASE_METHOD(AccessFixture, "A namespace has RolePermissions for nodes without their own",
                 "[unit:Security Role Server DefaultRolePermissions]")
{
    users.everybody.roles = {"Operator"};
    TestClient operator_client = log_in();
    server::NamespaceMetadata metadata;
    metadata.default_role_permissions.emplace().clear(); // deny by default
    const auto describe = [&] { // the smallest namespace 0 cannot show what counts in it, too
        const auto done = server.describe_namespace(1, metadata);
        return done ? status::Good : done.error();
    };
    REQUIRE((describe() == status::Good || describe() == status::Bad_NotSupported));
    CHECK(read(operator_client, "Value").status == status::Bad_NodeIdUnknown);
    CHECK(call(operator_client) == status::Bad_NodeIdUnknown);
    CHECK(browse(operator_client, "Area").status_code == status::Bad_NodeIdUnknown);
    // A node's own win, whatever its namespace says.
    permit(value, {role(id::WellKnownRole_Anonymous, may_browse | may_read)});
    CHECK(read(open, "Value").status == status::Good);
    CHECK(call(open) == status::Bad_NodeIdUnknown);

    metadata.default_role_permissions->push_back(
        role(id::WellKnownRole_Operator, may_browse | may_call));
    describe();
    CHECK(call(operator_client) == status::Good);
    CHECK(read(operator_client, "Area", AttributeId::RolePermissions).status ==
          status::Bad_AttributeIdInvalid); // it has none of its own
    CHECK(call(open) == status::Bad_NodeIdUnknown);
    metadata.default_access_restrictions = signing;
    describe();
    CHECK(read(open, "Value").status == weak);
    CHECK(call(operator_client) == weak);

    // Null is as at first.
    space().set_node_access(value, {});
    space().set_namespace_permissions(1, {});
    space().set_namespace_restrictions(1, 0);
    CHECK(read(open, "Value").status == status::Good);
    CHECK(browse(open, "Area").references.size() == 2);
}

TEST_CASE_METHOD(AccessFixture, "Each item of a request has the rights of its own node")
{
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.value = std::int32_t{7};
    const model::NodeIndex hidden = space().add_variable(named("Hidden", area), variable).value();
    REQUIRE(space().add_variable(named("Free", area), variable));
    permit(value, {role(id::WellKnownRole_Anonymous, may_browse | may_read)});
    permit(hidden, {role(id::WellKnownRole_Operator, may_browse | may_read)});
    ReadRequest request;
    for (const char* const name : {"Value", "Hidden", "Value", "Free", "Hidden", "Free", "Value"}) {
        ReadValueId& item = request.nodes_to_read.emplace_back();
        item.node_id = NodeId{1, name};
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    }
    const auto response = open.call<ReadResponse>(request);
    REQUIRE(response);
    std::vector<StatusCode> statuses;
    for (const DataValue& each : response->results) {
        statuses.push_back(each.status);
    }
    const StatusCode unknown = status::Bad_NodeIdUnknown;
    const StatusCode good = status::Good;
    CHECK(statuses == std::vector{good, unknown, good, good, unknown, good, good});
}

TEST_CASE_METHOD(AccessFixture, "Rights that change are not remembered")
{
    const server::UserIdentity user;
    const server::detail::NodeRights rights{space(), user};
    permit(value, {role(id::WellKnownRole_Anonymous, may_read)});
    CHECK(rights.is_permitted(PermissionType::Read, value));
    permit(value, {role(id::WellKnownRole_Anonymous, may_browse)});
    CHECK_FALSE(rights.is_permitted(PermissionType::Read, value));
    space().set_node_access(value, {});
    CHECK(rights.is_permitted(PermissionType::Read, value));
}

TEST_CASE_METHOD(AccessFixture, "What AccessLevelEx and WriteMask say",
                 "[unit:Address Space Atomicity][unit:Address Space Full Array Only]"
                 "[unit:Address Space NonVolatile and Constant]")
{
    model::NodeAccess access;
    access.write_mask = 0x65; // AccessLevel and BrowseName, which nobody writes, and two texts
    access.more_access_levels = static_cast<std::uint32_t>(AccessLevelExType::WriteFullArrayOnly);
    space().set_node_access(value, access);
    CHECK(read(open, "Value", AttributeId::WriteMask).value == Variant{0x60U});
    CHECK(read(open, "Value", AttributeId::UserWriteMask).value == Variant{0U}); // who only reads
    CHECK(read(signed_only, "Value", AttributeId::UserWriteMask).value == Variant{0x60U});
    CHECK(read(open, "Value", AttributeId::AccessLevelEx).value == Variant{0x403U});
    // Part 3, 8.58: NonatomicRead, NonatomicWrite, NonVolatile and Constant.
    for (const AccessLevelExType level :
         {AccessLevelExType::NonatomicRead, AccessLevelExType::NonatomicWrite,
          AccessLevelExType::NonVolatile, AccessLevelExType::Constant}) {
        model::NodeAccess other;
        other.more_access_levels = static_cast<std::uint32_t>(level);
        space().set_node_access(value, other);
        CHECK(read(open, "Value", AttributeId::AccessLevelEx).value ==
              Variant{0x3U | other.more_access_levels});
    }
    space().set_node_access(value, access);
    WriteRequest request;
    request.nodes_to_write.resize(1);
    request.nodes_to_write[0].node_id = NodeId{1, "Value"};
    request.nodes_to_write[0].attribute_id = 13;
    request.nodes_to_write[0].index_range = "0";
    request.nodes_to_write[0].value = DataValue{Variant{std::int32_t{8}}};
    CHECK(signed_only.call<WriteResponse>(request)->results[0] == status::Bad_WriteNotSupported);
}

} // namespace node_access_test

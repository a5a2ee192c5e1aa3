#include <catch2/catch.hpp>

#include <array>
#include <functional>
#include <utility>

#include <busbar/harness/bench.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/node_management.hpp>
#include <busbar/types/view.hpp>

#include "support/server_fixture.hpp"

namespace role_matrix_test {

// Every service that a permission decides about, for every well-known role and every bit: a session
// with the role may what its bits say and nothing else, whatever another role may.

using namespace busbar;
using namespace busbar::test;
using harness::BenchClient;

namespace {

struct Role {
    const char* name;
    std::uint32_t id;
    bool administrates{false};
};
constexpr std::array roles{
    Role{"Observer", id::WellKnownRole_Observer},
    Role{"Operator", id::WellKnownRole_Operator},
    Role{"Engineer", id::WellKnownRole_Engineer},
    Role{"Supervisor", id::WellKnownRole_Supervisor},
    Role{"ConfigureAdmin", id::WellKnownRole_ConfigureAdmin, true},
    Role{"SecurityAdmin", id::WellKnownRole_SecurityAdmin, true},
};

constexpr std::uint32_t bit(PermissionType type)
{
    return static_cast<std::uint32_t>(type);
}
constexpr std::uint32_t browse = bit(PermissionType::Browse);
constexpr std::uint32_t bits = 17;

/// What permissions are asked for is up to them alone.
struct AllowAll final : server::AccessControl {
    [[nodiscard]] std::uint8_t user_access_level(const server::UserIdentity&, const NodeId&,
                                                 std::uint8_t access_level) const override
    {
        return access_level;
    }
    [[nodiscard]] bool may_browse(const server::UserIdentity&, const NodeId&) const override
    {
        return true;
    }
    [[nodiscard]] bool may_add_node(const server::UserIdentity&, const NodeId&) const override
    {
        return true;
    }
    [[nodiscard]] bool may_delete_node(const server::UserIdentity&, const NodeId&) const override
    {
        return true;
    }
    [[nodiscard]] bool may_add_reference(const server::UserIdentity&, const NodeId&) const override
    {
        return true;
    }
    [[nodiscard]] bool may_remove_reference(const server::UserIdentity&,
                                            const NodeId&) const override
    {
        return true;
    }
};

/// The objects that outlive the server.
struct Parts {
    [[nodiscard]] harness::BenchOptions options() const
    {
        harness::BenchOptions options;
        options.server = harness::secured_server_config();
        options.server.has_node_management = true;
        options.server_parts.access = &everything;
        return options;
    }

    server::MethodTable methods;
    AllowAll everything;
};

struct Matrix : Parts, harness::Bench {
    Matrix() : Bench{options()}
    {
        auto& space = server().address_space();
        model::NewObject object;
        object.event_notifier = 1;
        area = space.add_object(named("Area"), object).value();
        doomed = space.add_object(named("Doomed")).value();
        model::NewVariable variable;
        variable.access_level = model::Access::ReadWrite;
        variable.data_type = NodeId{0, id::Int32};
        variable.value = std::int32_t{7};
        value = space.add_variable(named("Value"), variable).value();
        model::NewMethod method;
        method.source = server().add_source(methods);
        method.handle = methods.add([](server::MethodCall call) { call.succeed(); });
        go = space.add_method(named("Go"), method).value();
    }
    model::NewNode named(const char* name)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = server().address_space().find(id::ObjectsFolder);
        return node;
    }
    /// The role has these permissions, and every other one all.
    void permit(const Role& role, std::uint32_t permissions)
    {
        model::NodeAccess access;
        for (const Role& each : roles) {
            access.role_permissions.push_back(
                {NodeId{0, each.id},
                 static_cast<PermissionType>(each.id == role.id ? permissions : (1U << bits) - 1)});
        }
        access.write_mask = static_cast<std::uint32_t>(AttributeWriteMask::Description) |
                            static_cast<std::uint32_t>(AttributeWriteMask::RolePermissions);
        given = access;
        give();
    }
    void give()
    {
        for (const model::NodeIndex node : {value, go, area, doomed}) {
            server().address_space().set_node_access(node, given);
        }
    }
    /// As it was before a client managed nodes.
    void restore()
    {
        auto& space = server().address_space();
        static_cast<void>(space.remove(space.find(NodeId{1, "New"})));
        static_cast<void>(space.remove_reference(area, NodeId{0, id::Organizes}, value));
        static_cast<void>(space.remove_reference(area, NodeId{0, id::Organizes}, go));
        static_cast<void>(space.add_reference(area, NodeId{0, id::Organizes}, go));
        if (space.find(NodeId{1, "Doomed"}) == model::no_node) {
            doomed = space.add_object(named("Doomed")).value();
        }
        give();
    }
    /// A client of a user who has the role.
    [[nodiscard]] BenchClient& log_in(const Role& role)
    {
        users().add(role.name, "x", {0xFF, {role.name}});
        return Bench::log_in(client::NamedUser{role.name, "x"},
                             setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt));
    }

    model::NodeAccess given;
    model::NodeIndex area{};
    model::NodeIndex doomed{};
    model::NodeIndex value{};
    model::NodeIndex go{};
};

StatusCode read(BenchClient& client, AttributeId attribute)
{
    return client.read(NodeId{1, "Value"}, attribute).status;
}

StatusCode write(BenchClient& client, AttributeId attribute, Variant value)
{
    WriteRequest request;
    request.nodes_to_write.resize(1);
    request.nodes_to_write[0].node_id = NodeId{1, "Value"};
    request.nodes_to_write[0].attribute_id = static_cast<std::uint32_t>(attribute);
    request.nodes_to_write[0].value.value = std::move(value);
    const auto response = client.call<WriteResponse>(request);
    return response ? response->results[0] : response.error();
}

StatusCode call(BenchClient& client)
{
    const auto result = client.call(NodeId{0, id::ObjectsFolder}, NodeId{1, "Go"});
    return result ? result->status_code : result.error();
}

StatusCode browse_node(BenchClient& client)
{
    BrowseRequest request;
    request.nodes_to_browse.resize(1);
    request.nodes_to_browse[0].node_id = NodeId{1, "Value"};
    const auto response = client.call<BrowseResponse>(request);
    return response ? response->results[0].status_code : response.error();
}

StatusCode add_node(BenchClient& client)
{
    AddNodesRequest request;
    AddNodesItem& item = request.nodes_to_add.emplace_back();
    item.parent_node_id = NodeId{1, "Area"};
    item.requested_new_node_id = NodeId{1, "New"};
    item.reference_type_id = NodeId{0, id::HasComponent};
    item.browse_name = QualifiedName{1, "New"};
    item.node_class = NodeClass::Object;
    item.type_definition = NodeId{0, id::BaseObjectType};
    const auto response = client.call<AddNodesResponse>(request);
    return response ? response->results[0].status_code : response.error();
}

StatusCode delete_node(BenchClient& client)
{
    DeleteNodesRequest request;
    request.nodes_to_delete = {{NodeId{1, "Doomed"}, true}};
    const auto response = client.call<DeleteNodesResponse>(request);
    return response ? response->results[0] : response.error();
}

StatusCode add_reference(BenchClient& client)
{
    AddReferencesRequest request;
    AddReferencesItem& item = request.references_to_add.emplace_back();
    item.source_node_id = NodeId{1, "Area"};
    item.reference_type_id = NodeId{0, id::Organizes};
    item.is_forward = true;
    item.target_node_id = NodeId{1, "Value"};
    item.target_node_class = NodeClass::Variable;
    const auto response = client.call<AddReferencesResponse>(request);
    return response ? response->results[0] : response.error();
}

StatusCode delete_reference(BenchClient& client)
{
    DeleteReferencesRequest request;
    DeleteReferencesItem& item = request.references_to_delete.emplace_back();
    item.source_node_id = NodeId{1, "Area"};
    item.reference_type_id = NodeId{0, id::Organizes};
    item.is_forward = true;
    item.target_node_id = NodeId{1, "Go"};
    item.delete_bidirectional = true;
    const auto response = client.call<DeleteReferencesResponse>(request);
    return response ? response->results[0] : response.error();
}

/// An item for events of the area, in a Subscription of its own.
StatusCode subscribe_to_events(BenchClient& client)
{
    CreateSubscriptionRequest subscription;
    subscription.requested_publishing_interval = 1'000;
    subscription.requested_lifetime_count = 30;
    subscription.requested_max_keep_alive_count = 10;
    const auto made = client.call<CreateSubscriptionResponse>(subscription);
    if (!made) {
        return made.error();
    }
    CreateMonitoredItemsRequest request;
    request.subscription_id = made->subscription_id;
    MonitoredItemCreateRequest& item = request.items_to_create.emplace_back();
    item.item_to_monitor.node_id = NodeId{1, "Area"};
    item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::EventNotifier);
    item.monitoring_mode = MonitoringMode::Reporting;
    EventFilter filter;
    SimpleAttributeOperand& severity = filter.select_clauses.emplace_back();
    severity.type_definition_id = NodeId{0, id::BaseEventType};
    severity.browse_path = {QualifiedName{0, "Severity"}};
    severity.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    item.requested_parameters.filter = ExtensionObject::from(filter);
    const auto response = client.call<CreateMonitoredItemsResponse>(request);
    DeleteSubscriptionsRequest removal;
    removal.subscription_ids = {made->subscription_id};
    static_cast<void>(client.call<DeleteSubscriptionsResponse>(removal));
    return response ? response->results[0].status_code : response.error();
}

/// What a service needs besides Browse, and what it answers without.
struct Service {
    const char* name;
    std::uint32_t needs;
    StatusCode refused;
    std::function<StatusCode(BenchClient&)> use;
    /// Whatever their bits are but Browse (Part 3, 5.2.9).
    bool administrators_may{false};
    /// What it answers where Browse is missing.
    StatusCode hidden{status::Bad_NodeIdUnknown};
};

const std::vector<Service>& services()
{
    static const std::vector<Service> all{
        {"Browse", 0, status::Bad_NodeIdUnknown, browse_node},
        {"Read of the Value", bit(PermissionType::Read), status::Bad_UserAccessDenied,
         [](BenchClient& client) { return read(client, AttributeId::Value); }},
        {"Read of RolePermissions", bit(PermissionType::ReadRolePermissions),
         status::Bad_UserAccessDenied,
         [](BenchClient& client) { return read(client, AttributeId::RolePermissions); }, true},
        {"Read of the BrowseName", 0, status::Bad_NodeIdUnknown,
         [](BenchClient& client) { return read(client, AttributeId::BrowseName); }},
        {"Write", bit(PermissionType::Write), status::Bad_UserAccessDenied,
         [](BenchClient& client) { return write(client, AttributeId::Value, Variant{8}); }},
        {"Write of the Description", bit(PermissionType::WriteAttribute),
         status::Bad_UserAccessDenied,
         [](BenchClient& client) {
             return write(client, AttributeId::Description, Variant{LocalizedText{"a level"}});
         }},
        {"Write of RolePermissions", bit(PermissionType::WriteRolePermissions),
         status::Bad_UserAccessDenied,
         [](BenchClient& client) {
             const auto nobody = ExtensionObject::from(RolePermissionType{});
             return write(client, AttributeId::RolePermissions,
                          Variant{Array<ExtensionObject>{nobody}});
         }},
        {"Call", bit(PermissionType::Call), status::Bad_UserAccessDenied, call},
        {"AddNodes", bit(PermissionType::AddNode), status::Bad_UserAccessDenied, add_node, false,
         status::Bad_ParentNodeIdInvalid},
        {"DeleteNodes", bit(PermissionType::DeleteNode), status::Bad_UserAccessDenied, delete_node},
        {"AddReferences", bit(PermissionType::AddReference), status::Bad_UserAccessDenied,
         add_reference, false, status::Bad_SourceNodeIdInvalid},
        {"DeleteReferences", bit(PermissionType::RemoveReference), status::Bad_UserAccessDenied,
         delete_reference, false, status::Bad_SourceNodeIdInvalid},
        {"Events", bit(PermissionType::ReceiveEvents), status::Bad_UserAccessDenied,
         subscribe_to_events},
    };
    return all;
}

} // namespace

TEST_CASE("role matrix: a role may what its permissions say, by every bit and service",
          "[unit:Security Role Server RolePermissions]")
{
    Matrix matrix;
    std::size_t cells = 0;
    for (const Role& role : roles) {
        BenchClient& client = matrix.log_in(role);
        for (std::uint32_t number = 0; number < bits; ++number) {
            const std::uint32_t permission = 1U << number;
            matrix.permit(role, browse | permission);
            for (const Service& service : services()) {
                INFO(role.name << ", bit " << number << ", " << service.name);
                const bool may = service.needs == 0 || service.needs == permission ||
                                 (service.administrators_may && role.administrates);
                CHECK(name(service.use(client)) ==
                      name(may ? StatusCode{status::Good} : service.refused));
                matrix.restore();
                ++cells;
            }
            // Without Browse there is no such node, whatever else it has.
            matrix.permit(role, permission & ~browse);
            for (const Service& service : services()) {
                INFO(role.name << ", bit " << number << " without Browse, " << service.name);
                CHECK(name(service.use(client)) == name(service.hidden));
                matrix.restore();
                ++cells;
            }
        }
    }
    CHECK(cells == roles.size() * bits * services().size() * 2);
}

} // namespace role_matrix_test

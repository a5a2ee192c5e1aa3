#include <catch2/catch.hpp>

#include <array>
#include <functional>

#include <busbar/server/method_table.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/view.hpp>

#include "support/server_fixture.hpp"

// Every service that a permission decides about, for every well-known role and every bit: a session
// with the role may what its bits say and nothing else, whatever another role may.

using namespace busbar;
using namespace busbar::test;

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

/// Users with the roles that a test gives them.
struct RoleUsers final : server::UserStore {
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view name,
                                                      std::string_view) override
    {
        return server::UserIdentity{
            UserTokenType::UserName, std::string{name}, 0xFF, {std::string{name}}};
    }
    [[nodiscard]] server::UserIdentity anonymous() const override { return {}; }
};

struct Matrix {
    Matrix()
    {
        auto& space = server.address_space();
        model::NewVariable variable;
        variable.access_level = model::Access::ReadWrite;
        variable.data_type = NodeId{0, id::Int32};
        variable.value = std::int32_t{7};
        value = space.add_variable(named("Value"), variable).value();
        model::NewMethod method;
        method.source = server.add_source(methods);
        method.handle = methods.add([](server::MethodCall call) { call.succeed(); });
        go = space.add_method(named("Go"), method).value();
    }
    model::NewNode named(const char* name)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = server.address_space().find(id::ObjectsFolder);
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
        server.address_space().set_node_access(value, access);
        server.address_space().set_node_access(go, access);
    }
    [[nodiscard]] TestClient log_in(const Role& role)
    {
        TestClient client{server.connect("192.0.2.1", now).value(),
                          setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt),
                          channel::ChannelEnvironment{.random = &random,
                                                      .wall_clock = &wall_clock,
                                                      .log = &log,
                                                      .validator = &validator,
                                                      .identity = &client_identity()},
                          now};
        REQUIRE(client.create_session());
        REQUIRE(client.activate(client.user(role.name, "x")) == status::Good);
        return client;
    }

    server::MethodTable methods;
    SeededRandom random;
    FixedWallClock wall_clock;
    LogBook log;
    crypto::InsecureAcceptAnyCertificate validator;
    RoleUsers users;
    TimePoint now{};
    server::Server server{
        server::Server::create(ServerFixture::secure_config(), {.random = &random,
                                                                .wall_clock = &wall_clock,
                                                                .log = &log,
                                                                .validator = &validator,
                                                                .users = &users})
            .value()};
    model::NodeIndex value{};
    model::NodeIndex go{};
};

StatusCode read(TestClient& client, AttributeId attribute)
{
    ReadRequest request;
    request.nodes_to_read.resize(1);
    request.nodes_to_read[0].node_id = NodeId{1, "Value"};
    request.nodes_to_read[0].attribute_id = static_cast<std::uint32_t>(attribute);
    const auto response = client.call<ReadResponse>(request);
    return response ? response->results[0].status : response.error();
}

StatusCode write(TestClient& client)
{
    WriteRequest request;
    request.nodes_to_write.resize(1);
    request.nodes_to_write[0].node_id = NodeId{1, "Value"};
    request.nodes_to_write[0].attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    request.nodes_to_write[0].value.value = Variant{std::int32_t{8}};
    const auto response = client.call<WriteResponse>(request);
    return response ? response->results[0] : response.error();
}

StatusCode call(TestClient& client)
{
    CallRequest request;
    request.methods_to_call.resize(1);
    request.methods_to_call[0].object_id = NodeId{0, id::ObjectsFolder};
    request.methods_to_call[0].method_id = NodeId{1, "Go"};
    const auto response = client.call<CallResponse>(request);
    return response ? response->results[0].status_code : response.error();
}

StatusCode browse_node(TestClient& client)
{
    BrowseRequest request;
    request.nodes_to_browse.resize(1);
    request.nodes_to_browse[0].node_id = NodeId{1, "Value"};
    const auto response = client.call<BrowseResponse>(request);
    return response ? response->results[0].status_code : response.error();
}

/// What a service needs besides Browse, and what it answers without.
struct Service {
    const char* name;
    std::uint32_t needs;
    StatusCode refused;
    std::function<StatusCode(TestClient&)> use;
    /// Whatever their bits are but Browse (Part 3, 5.2.9).
    bool administrators_may{false};
};

const std::vector<Service>& services()
{
    static const std::vector<Service> all{
        {"Browse", 0, status::Bad_NodeIdUnknown, browse_node},
        {"Read of the Value", bit(PermissionType::Read), status::Bad_UserAccessDenied,
         [](TestClient& client) { return read(client, AttributeId::Value); }},
        {"Read of RolePermissions", bit(PermissionType::ReadRolePermissions),
         status::Bad_UserAccessDenied,
         [](TestClient& client) { return read(client, AttributeId::RolePermissions); }, true},
        {"Read of the BrowseName", 0, status::Bad_NodeIdUnknown,
         [](TestClient& client) { return read(client, AttributeId::BrowseName); }},
        {"Write", bit(PermissionType::Write), status::Bad_UserAccessDenied, write},
        {"Call", bit(PermissionType::Call), status::Bad_UserAccessDenied, call},
    };
    return all;
}

} // namespace

TEST_CASE("role matrix: a role may what its permissions say, by every bit and service")
{
    Matrix matrix;
    std::size_t cells = 0;
    for (const Role& role : roles) {
        auto client = matrix.log_in(role);
        for (std::uint32_t number = 0; number < bits; ++number) {
            const std::uint32_t permission = 1U << number;
            matrix.permit(role, browse | permission);
            for (const Service& service : services()) {
                INFO(role.name << ", bit " << number << ", " << service.name);
                const bool may = service.needs == 0 || service.needs == permission ||
                                 (service.administrators_may && role.administrates);
                CHECK(service.use(client) == (may ? StatusCode{status::Good} : service.refused));
                ++cells;
            }
            // Without Browse there is no such node, whatever else it has.
            matrix.permit(role, permission & ~browse);
            for (const Service& service : services()) {
                INFO(role.name << ", bit " << number << " without Browse, " << service.name);
                CHECK(service.use(client) == status::Bad_NodeIdUnknown);
                ++cells;
            }
        }
    }
    CHECK(cells == roles.size() * bits * services().size() * 2);
}

#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/server/running_server.hpp>

#include "administration/rights.hpp"
#include "managed_fixture.hpp"
#include "right_places.hpp"

/// A server with all Objects of the administration, nine identities that log in there, and which
/// row of the table of rights each of its nodes belongs to.
namespace right_matrix {

using namespace busbar;
using namespace busbar::test;
using namespace administration::detail;
using administration::Authorities;

struct Identity {
    const char* role; // null: anonymous, empty: a user without roles
    Roles roles;
};
inline constexpr std::array identities{
    Identity{nullptr, who::everybody},
    Identity{"", who::everybody},
    Identity{"TrustedApplication", who::everybody},
    Identity{"Observer", who::everybody},
    Identity{"Operator", who::everybody | who::operator_ | who::readers},
    Identity{"Supervisor", who::everybody | who::supervisor},
    Identity{"Engineer", who::everybody | who::engineer | who::writers},
    Identity{"ConfigureAdmin", who::everybody | who::configure_admin},
    Identity{"SecurityAdmin", who::everybody | who::security_admin},
};
inline constexpr std::array modes{MessageSecurityMode::None, MessageSecurityMode::Sign,
                                  MessageSecurityMode::SignAndEncrypt};

struct Node {
    std::string path;
    NodeId id;
    NodeId parent;
    Thing thing;
    Thing thing_of_parent;
    bool is_method;
    bool is_writable;
};

inline Thing thing_at(std::string_view path)
{
    const Place* best = nullptr;
    for (const Place& each : places) {
        if (fits(path, each.path) && (best == nullptr || each.path.size() > best->path.size())) {
            best = &each;
        }
    }
    INFO(path);
    REQUIRE(best != nullptr);
    return best->thing;
}

struct Matrix : ManagedFixture {
    explicit Matrix(Authorities of = Authorities::Standard) : ManagedFixture{nullptr, of}
    {
        auto config = ServerFixture::insecure_config();
        for (server::EndpointConfig& endpoint : config.endpoints) {
            endpoint.allows_anonymous = true;
        }
        REQUIRE(server::RunningServer{server}.reconfigure(std::move(config)));
        passwords.set_anonymous_access(0xFF);
        const auto hash = crypto::hash_password("x", random, {.log_n = 4});
        for (const Identity& each : identities) {
            if (each.role != nullptr) {
                std::vector<std::string> given;
                if (*each.role != '\0') {
                    given.emplace_back(each.role);
                }
                REQUIRE(passwords.set(user_of(each), *hash, {0xFF, given}));
            }
        }
        REQUIRE(file_storage.make_folder("", FileAccess::Owner));
        REQUIRE(file_storage.replace("a", {}, FileAccess::Owner));
        administration->refresh_files();
        complete();
        auto admin = log_in();
        REQUIRE(call(admin, NodeId{0, id::Server_ServerCapabilities_RoleSet},
                     NodeId{0, id::Server_ServerCapabilities_RoleSet_AddRole},
                     {Variant{String{"Fitter"}}, Variant{String{}}})
                    .status_code == status::Good);
    }
    static std::string user_of(const Identity& identity)
    {
        return "user" + std::string{identity.role};
    }
    [[nodiscard]] TestClient log_in_as(const Identity& identity, MessageSecurityMode mode)
    {
        const bool is_plain = mode == MessageSecurityMode::None;
        TestClient client{server.connect("192.0.2.1", now).value(),
                          is_plain ? channel::SecuritySetting{} : setting("Basic256Sha256", mode),
                          channel::ChannelEnvironment{.random = &random,
                                                      .wall_clock = &wall_clock,
                                                      .log = &log,
                                                      .validator = &any,
                                                      .identity = &client_identity()},
                          now};
        REQUIRE(client.create_session());
        REQUIRE(client.activate(identity.role == nullptr
                                    ? TestClient::anonymous()
                                    : client.user(user_of(identity), "x")) == status::Good);
        return client;
    }
    /// All Methods and Variables below the Objects of the administration.
    [[nodiscard]] std::vector<Node> nodes()
    {
        std::vector<Node> found;
        std::set<model::NodeIndex> seen;
        const auto& space = server.address_space();
        for (const NodeId& root :
             {NodeId{0, id::ServerConfiguration}, NodeId{0, id::Server_ServerCapabilities_RoleSet},
              NodeId{0, id::Server_RequestServerStateChange},
              NodeId{0, id::Server_ServerDiagnostics_ServerDiagnosticsSummary},
              NodeId{1, "Settings"}, NodeId{1, "Status"}, NodeId{1, "Files/recipes"},
              NodeId{1, "Transfers/backup"}}) {
            const model::NodeIndex node = space.find(root);
            REQUIRE(node != model::no_node);
            collect(node, {NodeId{0, id::Server}, Thing::Roles}, space.browse_name(node).name.str(),
                    found, seen);
        }
        return found;
    }

private:
    struct Above {
        NodeId id;
        Thing thing; // Thing::Roles asks for no channel
    };
    void collect(model::NodeIndex node, const Above& above, const std::string& path,
                 std::vector<Node>& found, std::set<model::NodeIndex>& seen)
    {
        const auto& space = server.address_space();
        const NodeClass node_class = space.node_class(node);
        if (!seen.insert(node).second) {
            return;
        }
        const Thing thing = node_class == NodeClass::Object && path.starts_with("RoleSet")
                                ? Thing::Roles
                                : thing_at(path);
        if (node_class != NodeClass::Object) {
            const bool is_writable =
                node_class == NodeClass::Variable &&
                (static_cast<unsigned>(space.variable(node).access_level) & 2U) != 0;
            found.push_back({path, space.node_id(node), above.id, thing, above.thing,
                             node_class == NodeClass::Method, is_writable});
        }
        std::vector<model::NodeIndex> children;
        model::ReferenceCursor cursor = space.references(node);
        while (const auto reference = cursor.next()) {
            if (reference->is_forward &&
                space.is_subtype_of(reference->type, id::HierarchicalReferences) &&
                space.node_class(reference->target) != NodeClass::ObjectType) {
                children.push_back(reference->target);
            }
        }
        for (const model::NodeIndex child : children) {
            const std::string name = space.browse_name(child).name.str();
            if (path != "backup" || name != "files") { // which is for nobody
                collect(child, {space.node_id(node), thing}, path + "/" + name, found, seen);
            }
        }
    }
};

inline constexpr const char* patience = "patience is all";

/// "pat" has a role by an IdentityMappingRule, which can be taken away.
struct Taken : Matrix {
    explicit Taken(const Identity& of) : identity{of}
    {
        REQUIRE(user_list.add({"pat", {}, 0, {}, {}}, patience, random));
        // Or the last rule of SecurityAdmin would stay.
        configured.replace({{.name = "chief", .roles = {"SecurityAdmin"}}});
        give();
        pat.emplace(log_in("pat", patience));
    }
    void give()
    {
        REQUIRE(roles.add_identity(identity.role, rule()));
        server::RunningServer{server}.roles_changed();
    }
    void take()
    {
        REQUIRE(roles.remove_identity(identity.role, rule()));
        server::RunningServer{server}.roles_changed();
    }
    /// By the role, and not because everybody has it.
    [[nodiscard]] bool has(Roles some) const
    {
        return (some & identity.roles) != 0 && (some & who::everybody) == 0;
    }

    const Identity& identity;
    std::optional<TestClient> pat;

private:
    [[nodiscard]] static IdentityMappingRuleType rule()
    {
        return {IdentityCriteriaType::UserName, "pat"};
    }
};

} // namespace right_matrix

#include <functional>
#include <string>
#include <vector>

#include <busbar/harness/bench.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/server/user_directory.hpp>

#include "managed_fixture.hpp"
#include "server/user_fixture.hpp"

namespace restricted_roles_test {

// A role's Applications and Endpoints (Part 18, 4.4.1) bind every session, however its user came to
// the role: by the configuration or by a rule, with a password, a certificate or an issued token.

using namespace busbar;
using namespace busbar::test;
using harness::BenchClient;

namespace {

constexpr const char* role = "SecurityAdmin";
constexpr const char* own_uri = "urn:busbar:harness:client";

/// A server for users of all kinds, whose roles are managed.
struct AllKinds : ManagedFixture {
    AllKinds()
    {
        REQUIRE(listed.load());
        directory.accept_certificates(user_validator);
        directory.set_certificate_rights(
            std::string{user_certificate().certificate.thumbprint_text()}, {0xFF, {role}});
        crypto::JwtRules tokens;
        tokens.issuer = "https://issuer";
        tokens.keys = {
            crypto::JwtKey::from_shared_secret(std::as_bytes(std::span{token_secret})).value()};
        directory.accept_tokens(std::move(tokens));
        REQUIRE(user_certificates.add(crypto::StoreList::Trusted,
                                      user_certificate().certificate.der()));
        REQUIRE(managed.attach(bench.server()));
    }
    [[nodiscard]] harness::BenchOptions options()
    {
        harness::BenchOptions options;
        options.server = harness::secured_server_config();
        options.server.application_uri = "urn:busbar:test:server"; // as tokens have it
        options.server.identity = server_identity();
        for (server::EndpointConfig& endpoint : options.server.endpoints) {
            endpoint.allows_certificate = endpoint.allows_issued = true;
        }
        options.server.issuer.authority_url = "https://issuer";
        options.server_parts.users = &directory;
        options.server_parts.roles = &roles;
        return options;
    }
    /// Whether the session has the role, which alone may read this.
    [[nodiscard]] static bool administrates(BenchClient& client)
    {
        constexpr std::uint32_t identities_of_observer = 16214;
        return client.read(NodeId{0, identities_of_observer}).status.is_good();
    }
    [[nodiscard]] BenchClient& with_password()
    {
        return bench.log_in(client::NamedUser{"admin", "admin-secret!"}, encrypt);
    }
    [[nodiscard]] BenchClient& with_certificate()
    {
        const auto key = std::make_shared<crypto::PrivateKey>(user_certificate().key);
        return bench.log_in(client::CertificateUser{user_certificate().certificate, key}, encrypt);
    }
    [[nodiscard]] BenchClient& with_token()
    {
        return bench.log_in(client::IssuedUser{jwt(R"(,"roles":["SecurityAdmin"])")}, encrypt);
    }
    void changed() { server::RunningServer{bench.server()}.roles_changed(); }

    crypto::StoreValidator user_validator{user_certificates, log};
    server::UserDirectory directory;
    administration::UserList listed{storage, "users.json", {}, directory.passwords()};
    harness::World world;
    administration::Administration managed{{.wall_clock = &world.clock(),
                                            .log = &log,
                                            .roles = &roles,
                                            .users = &listed,
                                            .certificates = &certificates,
                                            .random = &random}};
    harness::Bench bench{world, options()};
};

/// A way to the role.
struct Way {
    const char* name;
    std::function<void(AllKinds&)> prepare;
    std::function<BenchClient&(AllKinds&)> log_in;
};

const std::vector<Way>& ways()
{
    using Criteria = IdentityCriteriaType;
    static const auto by_rule = [](Criteria criteria, const char* text) {
        return [=](AllKinds& world) {
            REQUIRE(world.roles.add_identity(role, {criteria, String{text}}));
        };
    };
    static const auto nothing = [](AllKinds&) {};
    static const std::vector<Way> all{
        {"a user of the list", nothing, &AllKinds::with_password},
        {"a certificate of the configuration", nothing, &AllKinds::with_certificate},
        {"a token whose role the configuration names",
         [](AllKinds& world) { world.directory.set_role_access(role, 0xFF); },
         &AllKinds::with_token},
        {"a token and a rule for its role", by_rule(Criteria::Role, role), &AllKinds::with_token},
        {"a token and a rule for all users", by_rule(Criteria::AuthenticatedUser, ""),
         &AllKinds::with_token},
    };
    return all;
}

/// Lists that leave the session out, and what lets it in again.
struct Restriction {
    const char* name;
    std::function<void(administration::RoleList&)> exclude;
    std::function<void(administration::RoleList&)> include;
};

EndpointType over(MessageSecurityMode mode)
{
    EndpointType endpoint;
    endpoint.security_mode = mode;
    return endpoint;
}

const std::vector<Restriction>& restrictions()
{
    using administration::RoleList;
    static const std::vector<Restriction> all{
        {"other applications only",
         [](RoleList& roles) {
             REQUIRE(roles.add_application(role, "urn:another"));
             REQUIRE(roles.set_applications_exclude(role, false));
         },
         [](RoleList& roles) { REQUIRE(roles.add_application(role, own_uri)); }},
        {"all applications but this one",
         [](RoleList& roles) {
             REQUIRE(roles.set_applications_exclude(role, true));
             REQUIRE(roles.add_application(role, own_uri));
         },
         [](RoleList& roles) { REQUIRE(roles.remove_application(role, own_uri)); }},
        {"other endpoints only",
         [](RoleList& roles) {
             REQUIRE(roles.add_endpoint(role, over(MessageSecurityMode::Sign)));
             REQUIRE(roles.set_endpoints_exclude(role, false));
         },
         [](RoleList& roles) {
             REQUIRE(roles.add_endpoint(role, over(MessageSecurityMode::SignAndEncrypt)));
         }},
        {"all endpoints but this one",
         [](RoleList& roles) {
             REQUIRE(roles.set_endpoints_exclude(role, true));
             REQUIRE(roles.add_endpoint(role, over(MessageSecurityMode::SignAndEncrypt)));
         },
         [](RoleList& roles) {
             REQUIRE(roles.remove_endpoint(role, over(MessageSecurityMode::SignAndEncrypt)));
         }},
    };
    return all;
}

} // namespace

TEST_CASE("restricted roles: lists of applications and endpoints bind users of every kind",
          "[attack]")
{
    for (const Way& way : ways()) {
        for (const Restriction& restriction : restrictions()) {
            INFO(way.name << ", " << restriction.name);
            AllKinds world;
            way.prepare(world);
            BenchClient& before = way.log_in(world);
            CHECK(AllKinds::administrates(before));
            restriction.exclude(world.roles);
            world.changed();
            CHECK_FALSE(AllKinds::administrates(before)); // sessions that exist
            BenchClient& after = way.log_in(world);
            CHECK_FALSE(AllKinds::administrates(after));
            restriction.include(world.roles);
            world.changed();
            CHECK(AllKinds::administrates(before));
            CHECK(AllKinds::administrates(after));
        }
    }
}

TEST_CASE("restricted roles: a role that a token claims gives nothing by itself", "[attack]")
{
    AllKinds world;
    BenchClient& maria = world.with_token();
    CHECK_FALSE(AllKinds::administrates(maria));
    const auto added =
        maria.call(NodeId{0, id::UserManagement}, NodeId{0, id::UserManagement_AddUser},
                   {Variant{String{"eve"}}, Variant{String{"patience is all"}},
                    Variant{std::uint32_t{0}}, Variant{String{}}});
    REQUIRE(added);
    CHECK(added->status_code.is_bad());
    CHECK_FALSE(world.listed.find("eve"));
    world.directory.set_role_access("Operator", 0xFF); // which is another role
    BenchClient& again = world.with_token();
    CHECK_FALSE(AllKinds::administrates(again));
    REQUIRE(world.roles.add_identity(role, {IdentityCriteriaType::Role, "SecurityAdmin"}));
    world.changed();
    CHECK(AllKinds::administrates(again));
}

} // namespace restricted_roles_test

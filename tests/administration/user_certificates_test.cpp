#include <busbar/server/user_directory.hpp>

#include "managed_fixture.hpp"
#include "server/user_fixture.hpp"

namespace user_certificates_test {

// DefaultUserTokenGroup (Part 12, 7.8.3.4): the users that log in with certificates, while an
// administrator changes who they are.

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr std::uint32_t user_trust_list = 14123;
constexpr std::uint32_t add_certificate = 14151;
constexpr std::uint32_t remove_certificate = 14153;

const Issued& other_user()
{
    static const Issued issued = [] {
        CertificateOptions options;
        options.common_name = "tom";
        options.names = "";
        options.key_usage = "critical,digitalSignature";
        options.extended_key_usage = "clientAuth";
        return issue(options, key_number(4));
    }();
    return issued;
}

struct CertifiedUsers : ManagedFixture {
    CertifiedUsers()
    {
        REQUIRE(of_directory.load());
        directory.accept_certificates(user_validator);
        REQUIRE(managed.attach(open_server));
        for (const Issued* each : {&user_certificate(), &other_user()}) {
            REQUIRE(user_certificates.add(crypto::StoreList::Trusted, each->certificate.der()));
        }
    }
    static server::ServerConfig config()
    {
        server::ServerConfig config = ServerFixture::secure_config();
        config.endpoints.clear();
        for (const MessageSecurityMode mode :
             {MessageSecurityMode::Sign, MessageSecurityMode::SignAndEncrypt}) {
            server::EndpointConfig& endpoint = config.endpoints.emplace_back();
            endpoint.security = setting("Basic256Sha256", mode);
            endpoint.allows_certificate = true;
        }
        return config;
    }
    [[nodiscard]] TestClient visit()
    {
        TestClient client = connect_to(open_server);
        REQUIRE(client.create_session());
        return client;
    }
    [[nodiscard]] StatusCode activate(TestClient& client, const Issued& user)
    {
        return UserFixture::activate(client, certificate_token(user.certificate.der()),
                                     user_signature(client, user.key));
    }
    std::string_view remove(TestClient& admin, const Issued& user)
    {
        const CallMethodResult result =
            call(admin, NodeId{0, user_trust_list}, NodeId{0, remove_certificate},
                 {Variant{String{user.certificate.thumbprint_text()}}, Variant{true}});
        while (std::exchange(open_waker.is_awake, false)) {
            open_server.handle_completions(now);
        }
        return name(result.status_code);
    }

    crypto::StoreValidator user_validator{user_certificates, log};
    server::UserDirectory directory;
    administration::UserList of_directory{storage, "users.json", {}, directory.passwords()};
    administration::Administration managed{{.wall_clock = &wall_clock,
                                            .log = &log,
                                            .roles = &roles,
                                            .users = &of_directory,
                                            .certificates = &certificates,
                                            .random = &random}};
    NoteWaker open_waker;
    server::Server open_server{server::Server::create(config(), {.random = &random,
                                                                 .wall_clock = &wall_clock,
                                                                 .log = &log,
                                                                 .validator = &validator,
                                                                 .users = &directory,
                                                                 .roles = &roles,
                                                                 .waker = &open_waker})
                                   .value()};
};

} // namespace

TEST_CASE_METHOD(CertifiedUsers, "user certificates: who is taken out is out, others stay")
{
    auto admin = visit();
    REQUIRE(admin.activate(admin.user("admin", "admin-secret!")) == status::Good);
    auto maria = visit();
    REQUIRE(activate(maria, user_certificate()) == status::Good);
    auto tom = visit();
    REQUIRE(activate(tom, other_user()) == status::Good);
    CHECK(remove(admin, user_certificate()) == "Good");
    CHECK(use(maria).is_bad());
    CHECK(use(tom) == status::Good);
    CHECK(use(admin) == status::Good);
    auto again = visit();
    CHECK(activate(again, user_certificate()).is_bad());
    // Nobody is logged out by one who comes in.
    CHECK(name(call(admin, NodeId{0, user_trust_list}, NodeId{0, add_certificate},
                    {Variant{ByteString{user_certificate().certificate.der()}}, Variant{true}})
                   .status_code) == "Good");
    CHECK(use(tom) == status::Good);
    CHECK(activate(again, user_certificate()) == status::Good);
}

TEST_CASE_METHOD(CertifiedUsers, "user certificates: have no password that they could change")
{
    auto maria = visit();
    REQUIRE(activate(maria, user_certificate()) == status::Good);
    const auto changed =
        call(maria, NodeId{0, id::UserManagement}, NodeId{0, id::UserManagement_ChangePassword},
             {Variant{String{"admin-secret!"}}, Variant{String{"another secret!"}}});
    CHECK(name(changed.status_code) == "Bad_InvalidState");
    auto admin = visit();
    CHECK(admin.activate(admin.user("admin", "admin-secret!")) == status::Good);
}

} // namespace user_certificates_test

#include <catch2/catch.hpp>

#include <optional>

#include <busbar/client/attributes.hpp>
#include <busbar/client/connection.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/types/data_types.hpp>

#include "client_fixture.hpp"

namespace user_change_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

using Statuses = std::vector<StatusCode>;

constexpr std::uint32_t security_of_sessions =
    id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionSecurityDiagnosticsArray;

/// A client whose user changes; the server tells the users of its sessions to "admin".
struct Shift : ClientFixture {
    explicit Shift(client::ClientConfig config = named_user()) : ClientFixture{std::move(config)} {}
    void change(const char* user, const char* password = nullptr)
    {
        const std::string secret = password != nullptr ? password : std::string{user} + "-secret";
        client.change_user(client::NamedUser{user, secret},
                           [this](StatusCode status) { told.push_back(status); });
    }
    /// Those of the only session, or of that which began with "admin". Only "admin" may ask, and
    /// only a server with diagnostics answers.
    [[nodiscard]] std::vector<std::string> users_of_session()
    {
        std::vector<std::string> users;
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = NodeId{0, security_of_sessions};
        request.nodes_to_read[0].attribute_id = 13;
        client.call<ReadResponse>(std::move(request), [&](Result<ReadResponse> response) {
            REQUIRE(response);
            const auto* const all = response->results[0].value.array_if<ExtensionObject>();
            REQUIRE(all != nullptr);
            for (const ExtensionObject& each : *all) {
                const auto* const session = each.get_if<SessionSecurityDiagnosticsDataType>();
                REQUIRE(session != nullptr);
                const auto& history = session->client_user_id_history;
                if (all->size() == 1 || history[0].view() == "admin") {
                    users.clear();
                    for (const String& user : history) {
                        users.push_back(user.str());
                    }
                }
            }
        });
        run();
        return users;
    }
    [[nodiscard]] bool has_diagnostics()
    {
        return site->server.address_space().find(id::Server_ServerDiagnostics) != model::no_node;
    }

    Statuses told;
};

} // namespace

TEST_CASE("a session is given to another user and keeps what it has (Part 4, 5.7.3.1)",
          "[unit:Session Client Impersonate]")
{
    Shift plant;
    plant.connect();
    REQUIRE(plant.is_ready());
    plant.read(); // under way meanwhile
    plant.change("admin");
    CHECK(plant.told.empty()); // handlers run in poll()
    plant.run();
    CHECK(plant.told == Statuses{status::Good});
    CHECK(plant.answers == Statuses{status::Good});
    CHECK(plant.site->server.session_count() == 1);
    if (plant.has_diagnostics()) {
        CHECK(plant.users_of_session() == std::vector<std::string>{"operator", "admin"});
    }
    // The same after the connection was lost and the session taken over.
    plant.cut();
    plant.advance(2s);
    REQUIRE(plant.is_ready());
    if (plant.has_diagnostics()) {
        CHECK(plant.users_of_session().back() == "admin");
    }
}

TEST_CASE("a user that the server refuses leaves the old one in force")
{
    Shift plant{ClientFixture::configuration(client::NamedUser{"admin", "admin-secret"})};
    plant.connect();
    SECTION("by his password")
    {
        plant.change("operator", "wrong");
        plant.advance(1min); // wrong passwords are answered late
        CHECK(plant.told == Statuses{status::Bad_UserAccessDenied});
    }
    SECTION("because it takes no such users")
    {
        plant.client.change_user(client::IssuedUser{"token", "urn:no:such:token"},
                                 [&](StatusCode status) { plant.told.push_back(status); });
        plant.run();
        CHECK(plant.told == Statuses{status::Bad_IdentityTokenRejected});
    }
    SECTION("as another change is under way")
    {
        plant.change("admin");
        plant.change("operator");
        plant.run();
        CHECK(plant.told == Statuses{status::Good, status::Bad_InvalidState});
    }
    REQUIRE(plant.is_ready());
    plant.read();
    plant.run();
    CHECK(plant.answers.back() == status::Good);
    if (plant.has_diagnostics()) {
        CHECK(plant.users_of_session() == std::vector<std::string>{"admin"});
    }
}

TEST_CASE("a user may change while there is no session")
{
    Shift plant;
    SECTION("before the first")
    {
        plant.change("admin");
        plant.run();
        CHECK(plant.told == Statuses{status::Good_CompletesAsynchronously});
        plant.connect();
    }
    SECTION("while the connection is lost")
    {
        plant.connect();
        plant.cut();
        REQUIRE(plant.client.state() == client::ClientState::Waiting);
        plant.change("admin");
        plant.advance(2s);
        CHECK(plant.told == Statuses{status::Good_CompletesAsynchronously});
    }
    SECTION("not while one is made")
    {
        plant.is_carrying = false;
        plant.connect();
        plant.change("admin");
        plant.run();
        CHECK(plant.told == Statuses{status::Bad_InvalidState});
        plant.is_carrying = true;
        plant.run();
        CHECK(plant.is_ready());
        return;
    }
    REQUIRE(plant.is_ready());
    if (plant.has_diagnostics()) {
        CHECK(plant.users_of_session().back() == "admin");
    }
}

TEST_CASE("a change that nobody answers ends with the connection")
{
    Shift plant{ClientFixture::configuration(client::NamedUser{"admin", "admin-secret"})};
    plant.connect();
    plant.is_carrying = false;
    plant.change("operator");
    plant.run();
    SECTION("that is cut")
    {
        plant.cut();
        CHECK(plant.told == Statuses{status::Bad_ConnectionClosed});
    }
    SECTION("after its time")
    {
        plant.advance(15s);
        REQUIRE(plant.told.size() == 1);
        CHECK(plant.told[0].is_bad());
    }
    plant.is_carrying = true;
    plant.advance(1min);
    REQUIRE(plant.is_ready());
    if (plant.has_diagnostics()) {
        CHECK(plant.users_of_session().back() == "admin");
    }
}

TEST_CASE("what the server makes of the session's timeout can be read",
          "[unit:Session Client KeepAlive]")
{
    auto config = ClientFixture::named_user();
    config.session_timeout = 10min;
    config.keep_alive_interval = 1h; // longer than the timeout allows
    Shift plant{config};
    CHECK(plant.client.session_timeout() == Duration::zero());
    plant.connect();
    CHECK(plant.client.session_timeout() == 10min);
    plant.advance(1h);
    CHECK(plant.site->server.session_count() == 1);
    CHECK(plant.is_ready());
    CHECK(plant.client.session_timeout() == 10min);
}

namespace {

/// Never answers.
class SilentSource final : public server::DataSource {
public:
    void read(server::ReadBatch batch) override { kept.push_back(std::move(batch)); }

    std::vector<server::ReadBatch> kept;
};

server::ServerConfig one_request()
{
    auto config = UserFixture::all_kinds();
    config.limits.max_pending_requests = 1;
    return config;
}

} // namespace

TEST_CASE("the server is told of requests that are cancelled (Part 4, 5.7.5)",
          "[unit:Session Client Cancel]")
{
    SilentSource source;
    ClientFixture plant{ClientFixture::insecure(), one_request()};
    model::NewNode node;
    node.id = NodeId{1, "silent"};
    node.browse_name = QualifiedName{1, "silent"};
    node.parent = plant.site->server.address_space().find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.source = plant.site->server.add_source(source);
    variable.data_type = NodeId{0, id::Int32};
    REQUIRE(plant.site->server.address_space().add_variable(node, variable));
    plant.connect();
    const auto ask = [&] {
        ReadRequest request;
        request.nodes_to_read.push_back({node.id, 13, {}, {}});
        const auto id =
            plant.client.call<ReadResponse>(std::move(request), [&](Result<ReadResponse> response) {
                plant.answers.push_back(response ? StatusCode{} : response.error());
            });
        plant.run();
        return id;
    };
    for (int i = 0; i < 5; ++i) { // each has the only place
        plant.client.cancel(ask());
        plant.run();
    }
    CHECK(source.kept.size() == 5);
    CHECK(plant.answers.empty());
    ask();
    CHECK(source.kept.size() == 6);
    // Without one that is forgotten the next is refused.
    ask();
    CHECK(plant.answers == Statuses{status::Bad_ServerTooBusy});
    CHECK(plant.is_ready());
}

TEST_CASE("the server is not told of requests that are not under way")
{
    UserFixture site{UserFixture::all_kinds()};
    client::ConnectionConfig config;
    config.channel.endpoint_url = "opc.tcp://localhost:4840";
    client::Connection connection{
        config,
        {.random = &site.random, .wall_clock = &site.wall_clock, .log = &site.log},
        site.now};
    auto link = site.server.connect("192.0.2.1", site.now).value();
    std::vector<client::ConnectionEvent> events;
    const auto run = [&] {
        while (carry(connection, link, site.now) || carry(link, connection, site.now)) {
            while (auto event = connection.next_event()) {
                events.push_back(*std::move(event));
            }
        }
    };
    run();
    REQUIRE(events.size() == 1);
    REQUIRE(events[0].kind == client::ConnectionEvent::Kind::Ready);
    const auto answered = connection.send(ReadRequest{});
    REQUIRE(answered);
    run();
    CHECK(events.size() == 2);
    for (const std::uint32_t handle : {*answered, *answered + 1, 0U}) {
        connection.cancel(handle);
        CHECK(connection.output().empty());
    }
    const auto under_way = connection.send(ReadRequest{});
    REQUIRE(under_way);
    connection.consume(connection.output().size());
    connection.cancel(*under_way);
    CHECK_FALSE(connection.output().empty());
}

TEST_CASE("texts come in the locale that the configuration asks for")
{
    auto config = ClientFixture::insecure();
    config.locale_ids = {"de-CH", "en"};
    ClientFixture plant{config};
    auto& space = plant.site->server.address_space();
    REQUIRE(space.set_text(space.find(id::ObjectsFolder), AttributeId::DisplayName,
                           Variant{LocalizedText{"de", "Objekte"}}));
    plant.connect();
    LocalizedText name;
    ReadRequest request;
    request.nodes_to_read.push_back({NodeId{0, id::ObjectsFolder}, 4, {}, {}});
    plant.client.call<ReadResponse>(std::move(request), [&](Result<ReadResponse> response) {
        REQUIRE(response);
        name = response->results[0].value.value_or(LocalizedText{});
    });
    plant.run();
    CHECK(name == LocalizedText{"de", "Objekte"});
}

} // namespace user_change_test

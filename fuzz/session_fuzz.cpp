#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include <busbar/types/attribute.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/subscription.hpp>

#include "fuzz_script.hpp"
#include "kept_world.hpp"
#include "require.hpp"
#include "session_world.hpp"

namespace session_fuzz {

using namespace busbar;
using namespace busbar::fuzz;

namespace {

/// Takes what a request says from the script: mostly what is right, so that it comes far.
struct Chooser {
    template <typename T, std::size_t N>
    T one_of(const std::array<T, N>& values)
    {
        return values[script.byte() % N];
    }
    bool rarely() { return script.byte() % 8 == 7; }
    test::TestClient& client() { return world.client(script.byte() % SessionWorld::client_count); }
    Ticket& ticket() { return world.tickets[script.byte() % world.tickets.size()]; }
    ByteString bytes() { return ByteString{script.bytes(script.byte())}; }
    String url()
    {
        return String{one_of(std::array<std::string_view, 6>{
            "opc.tcp://localhost:4840", "opc.tcp://plc.example:4840/x", "opc.tcp://[::1]:1", "",
            "https://localhost", "opc.tcp://"})};
    }
    double timeout()
    {
        return one_of(std::array{60'000.0, 20'000.0, 0.0, -1.0, 1e300,
                                 std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::infinity()});
    }
    Array<String> texts()
    {
        Array<String> result(script.byte() % 4U);
        for (String& text : result) {
            text = String{one_of(std::array<std::string_view, 8>{
                "en", "de", "", "x", "urn:busbar:test:server", "urn:nobody",
                "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary",
                "http://opcfoundation.org/UA-Profile/Transport/https-uabinary"})};
        }
        return result;
    }
    ByteString certificate()
    {
        const auto client = test::client_identity().certificates.front().der();
        const auto server = test::server_identity().certificates.front().der();
        switch (script.byte() % 5) {
        case 0:
            return ByteString{client};
        case 1:
            return ByteString{server};
        case 2: {
            std::vector<std::byte> chain{client.begin(), client.end()};
            chain.insert(chain.end(), server.begin(), server.end());
            return ByteString{std::move(chain)};
        }
        case 3:
            return bytes();
        default:
            return {};
        }
    }
    SignatureData signature(const test::TestClient& client)
    {
        SignatureData data = client.signature();
        switch (script.byte() % 8) {
        case 6:
            data.algorithm = "http://www.w3.org/2001/04/xmldsig-more#rsa-sha256";
            data.signature = bytes();
            return data;
        case 7:
            return {};
        default:
            return data;
        }
    }

    SessionWorld& world;
    Script& script;
};

ExtensionObject password_token(Chooser& choose, const test::TestClient& client)
{
    const std::string user{
        choose.one_of(std::array<std::string_view, 4>{"maria", "admin", "operator", ""})};
    const std::string password = user + (choose.rarely() ? "-guess" : "-secret");
    if (client.is_secure()) {
        return client.user(user, password);
    }
    return test::user_token(crypto::policy_none(), user, password, {});
}

ExtensionObject certificate_token(Chooser& choose)
{
    X509IdentityToken token;
    token.policy_id = "certificate_Basic256Sha256";
    token.certificate_data = choose.certificate();
    return ExtensionObject::from(std::move(token));
}

ExtensionObject user_token(Chooser& choose, const test::TestClient& client)
{
    switch (choose.script.byte() % 8) {
    case 0:
    case 1:
        return test::TestClient::anonymous();
    case 2:
    case 3:
        return password_token(choose, client);
    case 4:
        return certificate_token(choose);
    case 5: {
        IssuedIdentityToken token;
        token.policy_id = "issued";
        token.token_data = choose.bytes();
        return ExtensionObject::from(std::move(token));
    }
    case 6:
        return ExtensionObject::from_binary(NodeId{0, UserNameIdentityToken::binary_encoding_id},
                                            choose.bytes());
    default:
        return {};
    }
}

/// Of a user with a certificate, over what the server wants to be signed.
SignatureData user_signature(Chooser& choose, const test::TestClient& client)
{
    if (choose.script.byte() % 4 == 0) {
        return choose.signature(client);
    }
    return test::sign_session(*crypto::find_policy_by_name("Basic256Sha256"),
                              test::client_identity(), client.server_nonce);
}

void create_session(Chooser& choose)
{
    test::TestClient& client = choose.client();
    CreateSessionRequest request = client.create_request();
    request.endpoint_url = choose.url();
    request.requested_session_timeout = choose.timeout();
    if (choose.rarely()) {
        request.client_nonce = choose.bytes();
    }
    if (choose.rarely()) {
        request.client_certificate = choose.certificate();
    }
    if (choose.rarely()) {
        request.client_description.application_uri = choose.url();
    }
    if (choose.rarely()) {
        request.session_name = String{std::string(choose.script.byte() * std::size_t{40}, 'n')};
        request.max_response_message_size = choose.script.byte() * 40U;
    }
    if (const auto made = client.create_session(std::move(request))) {
        require(made->revised_session_timeout >= 10'000 && made->revised_session_timeout <= 60'000);
        require(!made->authentication_token.is_null());
        choose.world.tickets.push_back({made->authentication_token, made->server_nonce});
    }
}

void activate_session(Chooser& choose)
{
    test::TestClient& client = choose.client();
    Ticket& ticket = choose.ticket();
    client.authentication_token = ticket.token;
    client.server_nonce = ticket.server_nonce;
    ActivateSessionRequest request;
    request.client_signature = choose.signature(client);
    request.user_identity_token = user_token(choose, client);
    if (request.user_identity_token.get_if<X509IdentityToken>() != nullptr) {
        request.user_token_signature = user_signature(choose, client);
    }
    request.locale_ids = choose.texts();
    static_cast<void>(client.take_activate(client.send(std::move(request))));
    ticket.server_nonce = client.server_nonce;
}

void close_session(Chooser& choose)
{
    test::TestClient& client = choose.client();
    client.authentication_token = choose.ticket().token;
    CloseSessionRequest request;
    request.delete_subscriptions = choose.script.byte() % 2 == 0;
    static_cast<void>(client.status_of<CloseSessionResponse>(request));
}

void cancel(Chooser& choose)
{
    test::TestClient& client = choose.client();
    client.authentication_token = choose.ticket().token;
    CancelRequest request;
    request.request_handle = client.last_handle - choose.script.byte() % 4U;
    static_cast<void>(client.status_of<CancelResponse>(request));
}

/// What changes with sessions, and one that is not there.
constexpr std::array<std::uint32_t, 8> read_nodes{
    id::Server_ServerStatus,
    id::Server_NamespaceArray,
    id::Server_ServerDiagnostics_SubscriptionDiagnosticsArray,
    1,
    id::Server_ServerDiagnostics_ServerDiagnosticsSummary,
    id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionDiagnosticsArray,
    id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionSecurityDiagnosticsArray,
    id::Server_ServerDiagnostics_EnabledFlag,
};

/// A request whose answers may have diagnostics, and which may wait.
void read(Chooser& choose)
{
    test::TestClient& client = choose.client();
    ReadRequest request;
    request.request_header.return_diagnostics = choose.script.byte() + choose.script.byte() * 256U;
    request.max_age = choose.timeout();
    request.timestamps_to_return = static_cast<TimestampsToReturn>(choose.script.byte() % 5);
    request.nodes_to_read.resize(choose.script.byte() % 4U);
    for (ReadValueId& each : request.nodes_to_read) {
        each.node_id = NodeId{0, choose.one_of(read_nodes)};
        each.attribute_id = choose.script.byte() % 30U;
        each.index_range = choose.one_of(std::array{"", "0", "x", "0:1"});
    }
    client.authentication_token = choose.ticket().token;
    static_cast<void>(client.status_of<ReadResponse>(std::move(request)));
}

void find_servers(Chooser& choose)
{
    FindServersRequest request;
    request.endpoint_url = choose.url();
    request.locale_ids = choose.texts();
    request.server_uris = choose.texts();
    static_cast<void>(choose.client().status_of<FindServersResponse>(std::move(request)));
}

void get_endpoints(Chooser& choose)
{
    GetEndpointsRequest request;
    request.endpoint_url = choose.url();
    request.locale_ids = choose.texts();
    request.profile_uris = choose.texts();
    static_cast<void>(choose.client().status_of<GetEndpointsResponse>(std::move(request)));
}

/// Which keeps something of a session when its channel is gone.
void subscribe(Chooser& choose)
{
    test::TestClient& client = choose.client();
    client.authentication_token = choose.ticket().token;
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = 1'000;
    request.requested_lifetime_count = 9;
    request.requested_max_keep_alive_count = 3;
    static_cast<void>(client.status_of<CreateSubscriptionResponse>(request));
    client.timeout_hint = choose.script.byte() * 40U;
    client.send(PublishRequest{});
    client.timeout_hint = 0;
}

void drop(Chooser& choose)
{
    choose.world.drop(choose.script.byte() % SessionWorld::client_count);
}

void let_time_pass(Chooser& choose)
{
    choose.world.advance(std::chrono::milliseconds{
        choose.one_of(std::array{1, 250, 1'000, 4'000, 9'999, 10'000, 20'000, 70'000})});
}

void change_users(Chooser& choose)
{
    test::PlainUsers& users = choose.world.users;
    const std::uint8_t choice = choose.script.byte();
    users.is_broken = choice % 8 == 7;
    users.must_change = (choice & 8U) != 0;
    users.everybody = (choice & 16U) != 0 ? server::UserIdentity{} : server::anonymous_reader();
    users.used_worker = (choice & 64U) != 0 ? &choose.world.jobs : nullptr;
    if ((choice & 32U) != 0) {
        users.rights = fail(status::Bad_UserAccessDenied);
    } else {
        users.rights = server::UserRights{};
    }
    choose.world.change_access();
}

void check_password(Chooser& choose)
{
    choose.world.work();
}

constexpr std::array steps{
    create_session, activate_session, create_session, activate_session,
    create_session, activate_session, read,           close_session,
    cancel,         find_servers,     get_endpoints,  subscribe,
    drop,           let_time_pass,    change_users,   check_password,
};

} // namespace

/// The services of sessions and discovery: who comes in, who stays, and who has to go.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    static KeptWorld<SessionWorld> kept;
    SessionWorld& world = kept.next();
    world.begin();
    Script script{{data, size}};
    Chooser choose{world, script};
    for (int i = 0; i < 32 && !script.is_over(); ++i) {
        steps[script.byte() % steps.size()](choose);
        world.check();
    }
    world.end();
    return 0;
}

} // namespace session_fuzz

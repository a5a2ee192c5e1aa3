#include <cstring>

#include <catch2/catch.hpp>

#include <busbar/crypto/security_policy.hpp>
#include <busbar/harness/catch.hpp>
#include <busbar/harness/client_host.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/harness/scripted_client.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/types/subscription.hpp>

namespace wrong_peer_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

constexpr const char* url = "opc.tcp://server:4840";
const NodeId level{1, "Level"};

ReadRequest read_request(const NodeId& node)
{
    ReadRequest request;
    ReadValueId& item = request.nodes_to_read.emplace_back();
    item.node_id = node;
    item.attribute_id = 13;
    return request;
}

ReadResponse read_response(Variant value)
{
    ReadResponse response;
    response.results.push_back(DataValue{std::move(value)});
    return response;
}

const channel::ApplicationIdentity& identity(const std::string& name)
{
    static std::map<std::string, channel::ApplicationIdentity> made;
    auto found = made.find(name);
    if (found == made.end()) {
        IdentityOptions options;
        options.name = name;
        found = made.emplace(name, make_identity(options).value()).first;
    }
    return found->second;
}

channel::SecuritySetting secured()
{
    return {crypto::find_policy_by_name("Basic256Sha256"), MessageSecurityMode::SignAndEncrypt};
}

/// A client and a server that the test writes for it, with or without security.
class Script {
public:
    explicit Script(bool is_secure)
        : server{world, url, parts(is_secure)}, client{world, config(is_secure),
                                                       client_parts(is_secure)}
    {
        server.accept_clients();
    }
    /// Reads the level; what a test expects is an answer, or the end of the connection.
    Result<ReadResponse> read() { return client.call<ReadResponse>(read_request(level)); }
    Expectation<ReadRequest> expect_read()
    {
        return server.expect<ReadRequest>().reply(read_response(1.5));
    }

    World world;
    ScriptedServer server;
    ConnectionHost client;

private:
    static ScriptedServerParts parts(bool is_secure)
    {
        ScriptedServerParts parts;
        if (is_secure) {
            parts.allowed = {secured()};
            parts.identity = &identity("server");
        }
        return parts;
    }
    static client::ConnectionConfig config(bool is_secure)
    {
        client::ConnectionConfig config = open_connection_config();
        if (is_secure) {
            config.channel.security = secured();
            config.channel.server_certificate = identity("server").certificates.front();
        }
        return config;
    }
    static ClientParts client_parts(bool is_secure)
    {
        ClientParts parts;
        parts.identity = is_secure ? &identity("client") : nullptr;
        return parts;
    }
};

} // namespace

TEST_CASE("a client finds out what is wrong with an answer", "[harness]")
{
    Script script{GENERATE(false, true)};
    Expectation<ReadRequest> read = script.expect_read();
    REQUIRE(script.client.open());
    StatusCode expected = status::Bad_SecureChannelClosed;
    SECTION("nothing")
    {
        REQUIRE(script.read());
        return;
    }
    SECTION("the sequence number again")
    {
        read.wrong({.sequence = Wrong::Sequence::Again});
        expected = status::Bad_SequenceNumberInvalid;
    }
    SECTION("a sequence number left out")
    {
        read.wrong({.sequence = Wrong::Sequence::Skipped});
        expected = status::Bad_SequenceNumberInvalid;
    }
    SECTION("another channel")
    {
        read.wrong({.channel_id = 4711});
        expected = status::Bad_TcpSecureChannelUnknown;
    }
    SECTION("another token")
    {
        read.wrong({.token_id = 4711});
        expected = status::Bad_SecureChannelTokenUnknown;
    }
    SECTION("no such chunk")
    {
        read.wrong({.chunk_flag = 'X'});
        expected = status::Bad_TcpMessageTypeInvalid;
    }
    CHECK_FALSE(script.read());
    CHECK(script.client.closed_by() == expected);
    CHECK(script.server.report() == "");
}

TEST_CASE("a client survives an answer that is not what it should be", "[harness]")
{
    Script script{GENERATE(false, true)};
    Expectation<ReadRequest> read = script.expect_read();
    REQUIRE(script.client.open());
    StatusCode expected = status::Bad_Timeout;
    SECTION("another request's")
    {
        read.wrong({.request_id = 4711});
    }
    SECTION("its chunk says that more follows")
    {
        read.wrong({.chunk_flag = 'C'});
    }
    SECTION("given up")
    {
        read.wrong({.abort = status::Bad_ResponseTooLarge});
        expected = status::Bad_ResponseTooLarge;
    }
    SECTION("never sent")
    {
        read.wrong({.copies = 0});
    }
    SECTION("short of a byte")
    {
        read.wrong({.cut_off = 1});
        expected = status::Bad_DecodingError;
    }
    CHECK(script.read().error() == expected);
    CHECK(script.server.report() == "");
}

TEST_CASE("a signature that is wrong ends a secured channel only", "[harness]")
{
    const bool is_secure = GENERATE(false, true);
    Script script{is_secure};
    script.expect_read().wrong({.signature = true});
    REQUIRE(script.client.open());
    static_cast<void>(script.read());
    if (is_secure) {
        CHECK(script.client.closed_by() == status::Bad_SecurityChecksFailed);
    } else {
        CHECK(script.client.is_ready());
    }
}

TEST_CASE("a scripted server answers twice, unasked, and when it is let", "[harness]")
{
    Script script{GENERATE(false, true)};
    REQUIRE(script.client.open());
    script.expect_read().twice();
    CHECK(script.read());
    CHECK(script.server.send(read_response(2.5), 4711));
    script.expect_read();
    CHECK(script.read());
    CHECK(script.client.is_ready());

    auto publish = script.server.expect<PublishRequest>().reply(PublishResponse{}).held();
    bool has_come = false;
    script.client.send<PublishResponse>(PublishRequest{}, [&](const Result<PublishResponse>&) { //
        has_come = true;
    });
    script.expect_read(); // is answered meanwhile
    CHECK(script.read());
    CHECK(publish.count() == 1);
    CHECK_FALSE(has_come);
    publish.let_go();
    script.world.run_for(1s);
    CHECK(has_come);
    CHECK(script.server.report() == "");

    script.client.drop();
    script.world.run_for(1s);
    CHECK(script.server.send(read_response(2.5), 1).error() == status::Bad_NotConnected);
}

TEST_CASE("what a scripted server expects depends on the content", "[harness]")
{
    Script script{false};
    REQUIRE(script.client.open());
    script.server.expect<ReadRequest>(reads(level)).reply(read_response(1.5));
    const NodeId other{1, "Other"};
    CHECK(script.client.call<ReadResponse>(read_request(other)).error() ==
          status::Bad_ServiceUnsupported);
    CHECK_THAT(script.server.report(), Catch::Contains("expected another ReadRequest, came"));
    script.server.allow<ReadRequest>(reads(other)).reply(read_response(7.0));
    CHECK_THAT(script.client.call<ReadResponse>(read_request(other))->results[0], holds(7.0));
    CHECK_THAT(script.read()->results[0], holds(1.5));
    CHECK(script.server.is_done());
}

TEST_CASE("a message of a scripted server is replaced by bytes", "[harness]")
{
    World world;
    ScriptedServer server{world, url};
    server.accept_clients();
    server.replace("ACK", {std::byte{0}, std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4},
                           std::byte{5}, std::byte{6}, std::byte{7}});
    ConnectionHost client{world};
    CHECK(client.open().error() == status::Bad_TcpMessageTypeInvalid);
    server.replace("OPN", {}); // the server is silent
    CHECK_FALSE(client.open());
    CHECK(client.open());
    server.send_bytes(std::array<std::byte, 8>{});
    world.run_for(1s);
    CHECK(client.closed_by() == status::Bad_TcpMessageTypeInvalid);
}

TEST_CASE("a client that looks for endpoints finds a scripted server, secured", "[harness]")
{
    World world;
    ScriptedServerParts parts;
    parts.allowed = {{}, secured()};
    parts.identity = &identity("server");
    ScriptedServer server{world, url, parts};
    server.accept_clients();
    server.allow<ReadRequest>(reads(level)).reply(read_response(1.5));
    client::ClientConfig config = open_client_config();
    config.security.min_mode = MessageSecurityMode::SignAndEncrypt;
    config.security.allows_none = false;
    ClientParts client_parts;
    client_parts.identity = &identity("client");
    ClientHost client{world, config, client_parts};
    CHECK_THAT(client.connect(), succeeds<void>());
    CHECK_THAT(client.call<ReadResponse>(read_request(level))->results[0], holds(1.5));
    world.run_for(1min); // it looks after the server's state
    CHECK(client.state() == client::ClientState::Ready);
    CHECK(server.report() == "");
}

TEST_CASE("faults and traces read what peers of the world send on secured channels", "[harness]")
{
    Script script{true};
    REQUIRE(script.client.open());
    script.world.network().play({fault::delay(2s).at(Message{"ReadResponse", 2}),
                                 fault::cut().after(Message{"ReadRequest", 3})});
    script.server.allow<ReadRequest>(reads(level)).reply(read_response(1.5));
    TimePoint before = script.world.now();
    CHECK(script.read());
    CHECK(script.world.now() - before < 1s);
    before = script.world.now();
    CHECK(script.read());
    CHECK(script.world.now() - before > 2s);
    CHECK_FALSE(script.read());
    CHECK_THAT(script.world.trace(), Catch::Contains("client -> ReadRequest ns=1;s=Level") &&
                                         Catch::Contains("server -> ReadResponse Double 1.5"));
}

TEST_CASE("a scripted client has sessions, and a server finds out what is wrong", "[harness]")
{
    const bool is_secure = GENERATE(false, true);
    World world;
    server::ServerConfig config = open_server_config();
    channel::ClientChannelConfig channel;
    channel.endpoint_url = url;
    ClientParts parts;
    if (is_secure) {
        config.identity = identity("server");
        config.endpoints[0].security = secured();
        channel.security = secured();
        channel.server_certificate = identity("server").certificates.front();
        parts.identity = &identity("client");
    }
    const ServerHost server{world, config};
    ScriptedClient client{world, channel, parts};
    CHECK(client.open_session().error() == status::Bad_NotConnected);
    REQUIRE(client.open());
    CHECK_THAT(client.open_session(), succeeds<void>());
    CHECK_FALSE(client.authentication_token().is_null());
    const ReadRequest read = read_request(NodeId{0, 2259U});
    REQUIRE(client.send(read));
    CHECK_THAT(client.expect<ReadResponse>()->results[0], holds(std::int32_t{0}));
    CHECK(client.token_id() != 0);
    CHECK(client.report() == "");

    Wrong wrong;
    StatusCode expected = status::Bad_SecurityChecksFailed; // details are not for attackers
    SECTION("the sequence number again")
    {
        wrong.sequence = Wrong::Sequence::Again;
    }
    SECTION("another channel")
    {
        wrong.channel_id = 4711;
        expected = status::Bad_TcpSecureChannelUnknown;
    }
    SECTION("another token")
    {
        wrong.token_id = client.token_id() + 7;
        expected = status::Bad_SecureChannelTokenUnknown;
    }
    SECTION("a signature, where there is one")
    {
        if (!is_secure) {
            return;
        }
        wrong.signature = true;
    }
    REQUIRE(client.send(read, wrong));
    CHECK(client.expect_close().value() == expected);
}

TEST_CASE("a scripted client says hello in its own way", "[harness]")
{
    World world;
    const ServerHost server{world};
    channel::ClientChannelConfig channel;
    channel.endpoint_url = url;
    ScriptedClient client{world, channel};
    REQUIRE(client.dial());
    // Part 6, 7.1.2.3: version 0, 8,192 bytes each way, no other limits, no URL.
    const std::string_view hello{"HELF\x20\0\0\0"
                                 "\0\0\0\0\0\x20\0\0\0\x20\0\0\0\0\0\0\0\0\0\0\0\0\0\0",
                                 32};
    client.send_bytes(std::as_bytes(std::span{hello}));
    world.run_for(1s);
    REQUIRE(client.received().size() == 28);
    CHECK(std::memcmp(client.received().data(), "ACKF", 4) == 0);
}

} // namespace wrong_peer_test

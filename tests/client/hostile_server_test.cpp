#include <catch2/catch.hpp>

#include <limits>

#include <busbar/client/client.hpp>
#include <busbar/types/method.hpp>

#include "crypto/status_text.hpp"
#include "support/rogue_server.hpp"

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::ClientState;

namespace {

const channel::SecuritySetting sign_and_encrypt{crypto::find_policy_by_name("Basic256Sha256"),
                                                MessageSecurityMode::SignAndEncrypt};

/// A client and a server that lies.
class RogueFixture {
public:
    explicit RogueFixture(bool is_secure = false)
        : client{config(is_secure), environment(client_identity()), now}
    {
        if (is_secure) {
            answers.security.push_back(sign_and_encrypt);
        }
    }
    void run()
    {
        bool moved = true;
        while (moved) {
            moved = client.poll(now);
            if (server) {
                moved = carry(client, *server, now) || moved;
                moved = carry(*server, client, now) || moved;
            }
            if (const auto order = client.next_order()) {
                obey(*order);
                moved = true;
            }
        }
    }
    void advance(Duration time)
    {
        now += time;
        client.handle_deadline(now);
        run();
    }
    void cut()
    {
        server.reset();
        client.disconnected(last_order, status::Bad_ConnectionClosed, now);
        run();
    }
    void connect()
    {
        client.connect(now);
        run();
    }
    [[nodiscard]] bool is_ready() const { return client.state() == ClientState::Ready; }
    void read()
    {
        client.call<ReadResponse>(ReadRequest{}, [this](Result<ReadResponse> response) {
            results.push_back(response ? StatusCode{} : response.error());
        });
        run();
    }

    TimePoint now{};
    SeededRandom random;
    FixedWallClock wall_clock;
    LogBook log;
    crypto::InsecureAcceptAnyCertificate validator;
    RogueAnswers answers;
    std::optional<RogueServer> server;
    client::Client client;
    std::vector<StatusCode> results;
    int connections{0};
    /// The last connection that was dropped ended with CloseSession.
    bool was_closed{false};
    std::uint64_t last_order{0};

private:
    [[nodiscard]] static client::ClientConfig config(bool is_secure)
    {
        client::ClientConfig config;
        config.endpoint_url = "opc.tcp://localhost:4840";
        config.application_uri = "urn:busbar:test:client";
        config.security.allows_none = !is_secure;
        return config;
    }
    [[nodiscard]] channel::ChannelEnvironment
    environment(const channel::ApplicationIdentity& identity)
    {
        return {&random, &wall_clock, &log, &validator, &identity};
    }
    void obey(const client::TransportOrder& order)
    {
        if (order.kind == client::TransportOrder::Kind::Drop) {
            if (server) {
                carry(client, *server, now);
                was_closed = !server->requests.empty() &&
                             server->requests.back().is(CloseSessionRequest::binary_encoding_id);
            }
            server.reset();
            client.disconnected(order.id, {}, now);
            return;
        }
        server.reset();
        ++connections;
        last_order = order.id;
        server.emplace(answers, environment(server_identity()), now);
        client.connected(order.id, now);
    }
};

std::vector<std::byte> bytes_of(std::size_t size)
{
    return std::vector<std::byte>(size, std::byte{0x11});
}

} // namespace

TEST_CASE("an honest server is not suspected")
{
    RogueFixture fixture{GENERATE(false, true)};
    fixture.connect();
    INFO(fixture.log.text);
    CHECK(fixture.is_ready());
    fixture.read();
    CHECK(fixture.results == std::vector<StatusCode>{status::Good});
}

TEST_CASE("what a hostile server says about the session is checked")
{
    RogueFixture fixture{true};
    StatusCode expected = status::Bad_SecurityChecksFailed;
    SECTION("another certificate")
    {
        fixture.answers.created = [](CreateSessionResponse& response) {
            response.server_certificate = ByteString{client_identity().certificates.front().der()};
        };
        expected = status::Bad_CertificateInvalid;
    }
    SECTION("no certificate")
    {
        fixture.answers.created = [](CreateSessionResponse& response) {
            response.server_certificate = {};
        };
        expected = status::Bad_CertificateInvalid;
    }
    SECTION("a signature over something else")
    {
        fixture.answers.created = [](CreateSessionResponse& response) {
            response.server_signature.signature = ByteString{bytes_of(256)};
        };
    }
    SECTION("no signature")
    {
        fixture.answers.created = [](CreateSessionResponse& response) {
            response.server_signature = {};
        };
    }
    SECTION("a short nonce")
    {
        fixture.answers.created = [](CreateSessionResponse& response) {
            response.server_nonce = ByteString{bytes_of(31)};
        };
        expected = status::Bad_NonceInvalid;
    }
    SECTION("the same nonce again")
    {
        fixture.answers.created = [](CreateSessionResponse& response) {
            response.server_nonce = ByteString{bytes_of(32)};
        };
        fixture.answers.activated = [](ActivateSessionResponse& response) {
            response.server_nonce = ByteString{bytes_of(32)};
        };
        expected = status::Bad_NonceInvalid;
    }
    fixture.connect();
    INFO(fixture.log.text);
    CHECK(fixture.client.state() == ClientState::Waiting);
    CHECK(fixture.client.last_error() == expected);
    CHECK_FALSE(fixture.log.text.empty());
}

TEST_CASE("a session has a token, and the endpoints that are known")
{
    RogueFixture fixture{true};
    StatusCode expected = status::Bad_SecurityChecksFailed;
    SECTION("no authentication token")
    {
        fixture.answers.created = [](CreateSessionResponse& response) {
            response.authentication_token = {};
        };
        expected = status::Bad_UnknownResponse;
    }
    SECTION("other endpoints than before")
    {
        fixture.answers.endpoints = [](GetEndpointsResponse& response) {
            EndpointDescription better = response.endpoints.back();
            better.security_policy_uri = crypto::security_policies().back().uri;
            better.user_identity_tokens[0].token_type = UserTokenType::UserName;
            response.endpoints.push_back(better);
        };
    }
    SECTION("no endpoints")
    {
        fixture.answers.created = [](CreateSessionResponse& response) {
            response.server_endpoints = {};
        };
    }
    fixture.connect();
    INFO(fixture.log.text);
    CHECK(fixture.client.state() == ClientState::Waiting);
    // Part 4, 5.7.2.2: the session is closed.
    CHECK(fixture.was_closed == (expected == status::Bad_SecurityChecksFailed));
    CHECK(fixture.client.last_error() == expected);
    CHECK_FALSE(fixture.log.text.empty());
}

TEST_CASE("a session timeout that makes no sense does no harm")
{
    const double revised =
        GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                 -1.0, 0.0, 1e-300, 1e300);
    RogueFixture fixture;
    fixture.answers.created = [&](CreateSessionResponse& response) {
        response.revised_session_timeout = revised;
    };
    fixture.connect();
    REQUIRE(fixture.is_ready());
    // The server is asked now and then, not all the time and not never.
    CHECK(fixture.client.next_deadline() >= fixture.now + 100ms);
    CHECK(fixture.client.next_deadline() <= fixture.now + 5s);
}

TEST_CASE("any answer of another kind ends the attempt, and the next one comes later each time")
{
    RogueFixture fixture;
    const auto request =
        GENERATE(GetEndpointsRequest::binary_encoding_id, CreateSessionRequest::binary_encoding_id,
                 ActivateSessionRequest::binary_encoding_id, ReadRequest::binary_encoding_id);
    const auto answer = GENERATE(body_of(CallResponse{}), std::vector<std::byte>{std::byte{9}},
                                 fault(status::Bad_TooManySessions), fault(status::Good),
                                 fault(status::Bad_InvalidTimestamp));
    fixture.answers.raw = [&](const NodeId& id) {
        return id.is(request) ? std::optional{answer} : std::nullopt;
    };
    fixture.connect();
    CHECK(fixture.client.state() == ClientState::Waiting);
    CHECK(fixture.client.last_error().is_bad());
    std::vector<Duration> waits;
    for (int i = 0; i < 8; ++i) {
        waits.push_back(fixture.client.next_deadline() - fixture.now);
        fixture.advance(waits.back());
    }
    CHECK(waits.front() >= 800ms);
    CHECK(waits.front() <= 1s);
    CHECK(waits.back() >= 24s);
    CHECK(waits.back() <= 30s);
    CHECK(fixture.connections <= 2 * 9);
}

TEST_CASE("a server that does not answer is given up after the time for an attempt")
{
    RogueFixture fixture;
    const auto request =
        GENERATE(GetEndpointsRequest::binary_encoding_id, CreateSessionRequest::binary_encoding_id,
                 ActivateSessionRequest::binary_encoding_id, ReadRequest::binary_encoding_id);
    fixture.answers.raw = [&](const NodeId& id) {
        return id.is(request) ? std::optional{std::vector<std::byte>{}} : std::nullopt;
    };
    fixture.connect();
    CHECK(fixture.client.next_deadline() <= fixture.now + 20s);
    fixture.advance(10s);
    fixture.advance(10s);
    CHECK(fixture.client.last_error() == status::Bad_Timeout);
}

TEST_CASE("what a server says about itself is bounded, and may be missing")
{
    RogueFixture fixture;
    std::vector<std::string> expected{"http://opcfoundation.org/UA/"};
    int too_many = 0;
    SECTION("nothing is there")
    {
        fixture.answers.read = [](const ReadRequest&, ReadResponse& response) {
            for (DataValue& value : response.results) {
                value.status = status::Bad_NodeIdUnknown;
            }
        };
    }
    SECTION("values of other types")
    {
        fixture.answers.read = [](const ReadRequest&, ReadResponse& response) {
            for (DataValue& value : response.results) {
                value.value = Variant{3.5};
            }
        };
    }
    SECTION("no service")
    {
        fixture.answers.raw = [](const NodeId& id) {
            return id.is(ReadRequest::binary_encoding_id)
                       ? std::optional{fault(status::Bad_ServiceUnsupported)}
                       : std::nullopt;
        };
        expected.clear();
    }
    SECTION("one node at a time")
    {
        fixture.answers.read = [&](const ReadRequest& request, ReadResponse& response) {
            if (request.nodes_to_read.size() > 1) {
                response.response_header.service_result = status::Bad_TooManyOperations;
                response.results = {};
                ++too_many;
            }
        };
    }
    SECTION("more than anybody needs")
    {
        fixture.answers.read = [](const ReadRequest&, ReadResponse& response) {
            response.results[0].value = Variant{Array<String>(60'000)};
        };
        expected.assign(10'000, "");
    }
    fixture.connect();
    INFO(fixture.log.text);
    CHECK(fixture.is_ready());
    CHECK(fixture.client.server().namespaces == expected);
    CHECK(fixture.client.server().operation_limits == client::OperationLimits{});
    CHECK(too_many <= 1);
}

TEST_CASE("results that were not asked for are no answer")
{
    RogueFixture fixture;
    const std::size_t count = GENERATE(0U, 9U, 11U, 5'000U);
    fixture.answers.read = [&](const ReadRequest&, ReadResponse& response) {
        response.results.resize(count);
    };
    fixture.connect();
    CHECK(fixture.client.last_error() == status::Bad_UnknownResponse);
}

TEST_CASE("a list of endpoints without end is not looked through")
{
    RogueFixture fixture;
    fixture.answers.endpoints = [](GetEndpointsResponse& response) {
        const EndpointDescription one = response.endpoints[0];
        response.endpoints.resize(501);
        std::ranges::fill(response.endpoints, one);
    };
    fixture.connect();
    CHECK(fixture.client.last_error() == status::Bad_ResponseTooLarge);
}

TEST_CASE("answers that nobody asked for, or that come twice, are dropped")
{
    RogueFixture fixture;
    fixture.connect();
    REQUIRE(fixture.is_ready());
    fixture.server->send(4'711, body_of(ReadResponse{}));
    fixture.run();
    fixture.read();
    fixture.server->send(fixture.server->answered.back(), body_of(ReadResponse{}));
    fixture.run();
    CHECK(fixture.results.size() == 1);
    CHECK(fixture.is_ready());
}

TEST_CASE("a server that stumbles over a session that is taken over gets a new one")
{
    RogueFixture fixture;
    fixture.connect();
    int taken_over = 0;
    fixture.answers.raw = [&](const NodeId& id) -> std::optional<std::vector<std::byte>> {
        const auto is_create = [](const NodeId& each) {
            return each.is(CreateSessionRequest::binary_encoding_id);
        };
        if (id.is(ActivateSessionRequest::binary_encoding_id) &&
            std::ranges::none_of(fixture.server->requests, is_create)) {
            ++taken_over;
            return std::vector<std::byte>{};
        }
        return std::nullopt;
    };
    fixture.cut();
    for (int i = 0; i < 8 && !fixture.is_ready(); ++i) {
        fixture.advance(10s);
    }
    CHECK(fixture.is_ready());
    CHECK(taken_over == 2);
}

TEST_CASE("a session that the server no longer knows is replaced")
{
    const StatusCode gone = GENERATE(status::Bad_SessionIdInvalid, status::Bad_SessionClosed,
                                     status::Bad_SessionNotActivated);
    RogueFixture fixture;
    fixture.connect();
    fixture.answers.raw = [&](const NodeId& id) {
        return id.is(ReadRequest::binary_encoding_id) ? std::optional{fault(gone)} : std::nullopt;
    };
    fixture.read();
    CHECK(fixture.results == std::vector<StatusCode>{gone});
    CHECK(fixture.client.state() == ClientState::Waiting);
    fixture.answers.raw = nullptr;
    fixture.advance(1s);
    CHECK(fixture.is_ready());
    CHECK(fixture.server->requests.front().is(CreateSessionRequest::binary_encoding_id));
}

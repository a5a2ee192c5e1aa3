#include <catch2/catch.hpp>

#include <limits>

#include "rogue_fixture.hpp"

namespace hostile_session_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::ClientState;

namespace {

std::vector<std::byte> bytes_of(std::size_t size)
{
    return std::vector<std::byte>(size, std::byte{0x11});
}

} // namespace

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

} // namespace hostile_session_test

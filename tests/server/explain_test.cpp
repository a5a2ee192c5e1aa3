#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <busbar/types/attribute.hpp>

#include "support/server_fixture.hpp"

namespace explain_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

const auto sign = setting("Basic256Sha256", MessageSecurityMode::Sign);

/// What was logged since the last call.
std::string news(ServerFixture& fixture)
{
    return std::exchange(fixture.log.text, {});
}

void check(const std::string& text, const std::vector<std::string>& parts)
{
    INFO(text);
    CHECK(std::count(text.begin(), text.end(), '\n') == 1);
    CHECK(text.find("192.0.2.1: ") != std::string::npos);
    for (const std::string& part : parts) {
        INFO(part);
        CHECK(text.find(part) != std::string::npos);
    }
}

StatusCode read(TestClient& client)
{
    return client.status_of<ReadResponse>(ReadRequest{});
}

} // namespace

TEST_CASE("the log says why CreateSession was refused", "[explain]")
{
    ServerFixture fixture;
    auto client = fixture.connect(sign);
    auto request = client.create_request();
    static_cast<void>(news(fixture));

    request.client_nonce = ByteString{std::vector<std::byte>(31)};
    CHECK_FALSE(client.create_session(request));
    check(news(fixture),
          {"client nonce failed", "31 bytes", "Bad_NonceInvalid", "Part 4, 5.7.2.2"});

    request = client.create_request();
    request.client_certificate = ByteString{server_identity().certificates.front().der()};
    CHECK_FALSE(client.create_session(request));
    check(news(fixture), {"client certificate failed", "not the one that the channel was opened "
                                                       "with"});

    request = client.create_request();
    request.client_description.application_uri = "urn:other\n";
    CHECK_FALSE(client.create_session(request));
    check(news(fixture),
          {"ApplicationUri failed", "urn:other\\x0A", "urn:busbar:test:client",
           "Bad_CertificateUriInvalid", client_identity().certificates.front().thumbprint_text()});
}

TEST_CASE("the log says that a channel is for discovery only", "[explain]")
{
    ServerFixture fixture{ServerFixture::secure_config()};
    auto client = fixture.connect();
    static_cast<void>(news(fixture));
    CHECK(client.create_session().error() == status::Bad_SecurityPolicyRejected);
    check(news(fixture), {"security of the session failed", "None, which is for discovery only",
                          "choose one of the endpoints"});
}

TEST_CASE("the log says why a request has no session", "[explain]")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    static_cast<void>(news(fixture));
    CHECK(read(client) == status::Bad_SessionIdInvalid);
    check(news(fixture), {"authenticationToken failed", "no session has it", "Part 4, 5.7.2.1"});

    auto other = fixture.log_in();
    client.adopt(other);
    static_cast<void>(news(fixture));
    CHECK(read(client) == status::Bad_SecureChannelIdInvalid);
    check(news(fixture),
          {"\"test\" is used over another channel than its own", "has to activate its session"});
}

TEST_CASE("the log says that there is no place, and who gave way", "[explain]")
{
    auto config = ServerFixture::insecure_config();
    config.limits.max_connections = 2;
    config.limits.max_connections_per_address = 2;
    config.limits.max_sessions_per_channel = 1;
    ServerFixture fixture{std::move(config)};
    auto user = fixture.log_in();
    auto idle = fixture.connect();
    static_cast<void>(news(fixture));

    CHECK_FALSE(user.create_session());
    check(news(fixture),
          {"place for a session failed", "1 sessions over this channel", "Bad_TooManySessions"});
    {
        auto second = fixture.connect(); // in the place of the idle one
        check(news(fixture), {"a connection from 192.0.2.1 takes the place of this one, the oldest "
                              "without an activated session; the limit is "
                              "max_connections_per_address"});
        REQUIRE(second.open_session() == status::Good);
        static_cast<void>(news(fixture));
        CHECK_FALSE(fixture.server.connect("192.0.2.1", fixture.now));
        check(news(fixture), {"place for a connection failed", "2 connections from this address",
                              "Bad_TcpServerTooBusy"});
    }
    auto again = fixture.connect();
    static_cast<void>(news(fixture));
    auto next = fixture.connect({}, client_identity(), "192.0.2.2");
    check(news(fixture), {"the oldest without an activated session", "Part 4, 5.6.2.1"});
}

TEST_CASE("the log says why a connection was closed", "[explain]")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    static_cast<void>(news(fixture));
    fixture.advance(31s, client);
    REQUIRE(client.is_closed());
    check(news(fixture),
          {"session timeout failed", "no activated session within 30 s", "Bad_Timeout"});
}

} // namespace explain_test

#include <catch2/catch.hpp>

#include <memory>
#include <vector>

#include "support/server_fixture.hpp"

namespace channel_ration_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

using Bytes = std::vector<std::byte>;

/// What becomes of a replayed OpenSecureChannel.
enum class Outcome : std::uint8_t { Opened, Refused, Failed, Waits };

/// Counts chains that were looked at, which is what comes before the private key's work.
class CountingValidator final : public crypto::CertificateValidator {
public:
    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain&,
                                         const crypto::ValidationContext&) override
    {
        ++count;
        return {};
    }

    int count{0};
};

/// A server, the messages of a good client as somebody has overheard them, and who sends them
/// again.
struct Overheard {
    Overheard()
    {
        // Hello is the same each time; the Acknowledge that is awaited comes from a server that
        // is forgotten at once.
        auto accepted = server.connect("192.0.2.99", now).value();
        channel::ClientChannelConfig client_config;
        client_config.endpoint_url = "opc.tcp://localhost:4840";
        client_config.security = security;
        client_config.server_certificate = server_identity().certificates.front();
        channel::ClientChannel client{client_config, environment(), now};
        hello = take_output(client);
        REQUIRE(accepted.feed(hello, now));
        carry(accepted, client, now);
        while (client.next_event()) {
        }
        open = take_output(client);
        REQUIRE(open.size() > 1'000);
    }
    [[nodiscard]] channel::ChannelEnvironment environment()
    {
        return {.random = &random,
                .wall_clock = &wall_clock,
                .log = &log,
                .validator = &accepts_any,
                .identity = &client_identity()};
    }
    static server::ServerConfig config()
    {
        server::ServerConfig config = ServerFixture::insecure_config();
        config.limits.max_connections = 1'000;
        config.limits.max_connections_per_address = 1'000;
        config.limits.max_token_lifetime = 20s;
        return config;
    }
    static server::ServerEnvironment server_environment(Overheard& self)
    {
        return {.random = &self.random,
                .wall_clock = &self.wall_clock,
                .log = &self.log,
                .validator = &self.validator,
                .users = &self.users};
    }
    static Outcome outcome_of(const server::Connection& connection)
    {
        const auto out = connection.output();
        if (out.empty()) {
            return Outcome::Waits;
        }
        if (out[0] == std::byte{'O'}) {
            return Outcome::Opened;
        }
        binary::Reader reader{out};
        reader.skip(8);
        return StatusCode{reader.number<std::uint32_t>()} == status::Bad_TcpServerTooBusy
                   ? Outcome::Refused
                   : Outcome::Failed;
    }
    /// Sends both messages over a new connection, which is given back.
    std::unique_ptr<server::Connection> replay(std::string_view address, const Bytes& what)
    {
        auto connection =
            std::make_unique<server::Connection>(server.connect(address, now).value());
        static_cast<void>(connection->feed(hello, now));
        connection->consume(connection->output().size());
        static_cast<void>(connection->feed(what, now));
        return connection;
    }
    /// The same, and hangs up at once.
    Outcome attack(std::string_view address, const Bytes& what)
    {
        return outcome_of(*replay(address, what));
    }
    [[nodiscard]] TestClient connect(std::string_view address)
    {
        return {server.connect(address, now).value(), security, environment(), now};
    }
    /// Time passes for the server and a client's connection.
    void advance(Duration time, TestClient& client)
    {
        now += time;
        server.handle_deadline(now);
        client.connection.handle_deadline(now);
        client.run();
    }

    const channel::SecuritySetting security{
        setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt)};
    SeededRandom random;
    FixedWallClock wall_clock;
    LogBook log;
    CountingValidator validator;
    crypto::InsecureAcceptAnyCertificate accepts_any;
    PlainUsers users;
    TimePoint now{1h};
    server::Server server{server::Server::create(config(), server_environment(*this)).value()};
    Bytes hello;
    Bytes open;
};

std::size_t lines_with(const std::string& text, std::string_view word)
{
    std::size_t count = 0;
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
        ++count;
    }
    return count;
}

} // namespace

TEST_CASE_METHOD(Overheard, "a replayed OpenSecureChannel costs the server ever less")
{
    int opened = 0;
    int refused = 0;
    int waiting = 0;
    // 500 a second for 10 seconds, as in a flood; who has to wait hangs up.
    for (int i = 0; i < 5'000; ++i, now += 2ms) {
        switch (attack("192.0.2.66", open)) {
        case Outcome::Opened:
            ++opened;
            break;
        case Outcome::Refused:
            ++refused;
            break;
        case Outcome::Waits:
            ++waiting;
            break;
        case Outcome::Failed:
            FAIL("nothing is wrong with the message");
        }
    }
    CHECK(opened == 5); // max_channel_failures: none has ever shown the keys
    CHECK(validator.count == opened);
    CHECK(opened + refused + waiting == 5'000);
    CHECK(waiting <= 200); // one each channel_interval, for which nothing is done
    CHECK(lines_with(log.text, "Bad_TcpServerTooBusy") <= 1 + 5'000 / 2'500);

    SECTION("nobody else is concerned")
    {
        auto client = connect("192.0.2.1");
        CHECK(client.open_session() == status::Good);
    }
    SECTION("nor is it for long")
    {
        now += 25s;
        auto client = connect("192.0.2.66");
        CHECK(client.open_session() == status::Good);
    }
}

TEST_CASE_METHOD(Overheard, "also where it waits for its turn each time")
{
    std::vector<std::unique_ptr<server::Connection>> attackers(20);
    for (int i = 0; i < 600; ++i, now += 100ms) {
        for (auto& attacker : attackers) {
            if (attacker) {
                attacker->handle_deadline(now);
            }
            if (!attacker || outcome_of(*attacker) != Outcome::Waits) {
                attacker = replay("192.0.2.66", open);
            }
        }
    }
    // All that had a turn before the first failures, then one each failed_channel_interval.
    CHECK(validator.count <= 40 + 30);
    CHECK(validator.count >= 30);
}

TEST_CASE_METHOD(Overheard, "so does one whose signature is not right")
{
    Bytes broken = open;
    broken.back() ^= std::byte{1};
    int failed = 0;
    for (int i = 0; i < 100; ++i) {
        failed += attack("2001:db8::" + std::to_string(i), broken) == Outcome::Failed ? 1 : 0;
    }
    CHECK(failed == 5); // all are of one network
    CHECK(validator.count == 5);
}

TEST_CASE_METHOD(Overheard, "a peer at the address of an attacker waits for its turn")
{
    for (int i = 0; i < 6; ++i) {
        static_cast<void>(attack("192.0.2.66", open));
    }
    auto client = connect("192.0.2.66");
    CHECK_FALSE(client.channel.is_open());
    CHECK(client.connection.has_enough());
    const TimePoint turn = client.connection.next_deadline();
    CHECK(turn > now);
    CHECK(turn <= now + 5s);
    advance(turn - now, client);
    CHECK_FALSE(client.connection.has_enough());
    CHECK(client.open_session() == status::Good);
    CHECK(attack("192.0.2.66", open) == Outcome::Opened); // a channel that worked has forgiven all
}

TEST_CASE_METHOD(Overheard, "a channel that works renews its token whatever happens around it")
{
    auto client = connect("192.0.2.66");
    REQUIRE(client.open_session() == status::Good);
    for (int i = 0; i < 100; ++i) {
        static_cast<void>(attack("192.0.2.66", open));
    }
    const TimePoint renewal = client.channel.next_deadline();
    server.handle_deadline(renewal);
    now = renewal;
    client.connection.handle_deadline(now);
    for (int i = 0; i < 100; ++i) {
        static_cast<void>(attack("192.0.2.66", open));
    }
    const int before = validator.count;
    client.channel.handle_deadline(now);
    client.run();
    CHECK(validator.count == before + 1);
    CHECK_FALSE(client.connection.has_enough());
    CHECK(client.channel.next_deadline() > now);
}

TEST_CASE_METHOD(Overheard, "many clients of one address that mean well are not held up")
{
    std::vector<TestClient> clients;
    for (int i = 0; i < 60; ++i) {
        auto& client = clients.emplace_back(connect("192.0.2.7"));
        CHECK(client.open_session() == status::Good);
    }
}

TEST_CASE_METHOD(Overheard, "a connection that waits is served like others when it ends")
{
    std::vector<std::unique_ptr<server::Connection>> waiting;
    for (int i = 0; i < 12; ++i) {
        waiting.push_back(replay("192.0.2.66", open));
    }
    auto& last = *waiting.back();
    CHECK(last.has_enough());
    CHECK(validator.count == 10); // max_channel_burst
    server.begin_shutdown(now, "maintenance");
    now += 10s;
    server.handle_deadline(now);
    CHECK(last.is_closed());
    CHECK_FALSE(last.has_enough());
    CHECK(validator.count == 10);
}

} // namespace channel_ration_test

#include <catch2/catch.hpp>

#include "support/channel_pair.hpp"

namespace channel_test {

using namespace busbar;
using namespace busbar::test;
using channel::ChannelEvent;
using Kind = ChannelEvent::Kind;

namespace {

std::vector<channel::SecuritySetting> all_settings()
{
    std::vector<channel::SecuritySetting> settings{{}};
    for (const char* policy : {"Basic256Sha256", "Aes128_Sha256_RsaOaep", "Aes256_Sha256_RsaPss"}) {
        settings.push_back(setting(policy, MessageSecurityMode::Sign));
        settings.push_back(setting(policy, MessageSecurityMode::SignAndEncrypt));
    }
    return settings;
}

ByteString bytes(std::size_t size)
{
    std::vector<std::byte> content(size);
    for (std::size_t i = 0; i < size; ++i) {
        content[i] = static_cast<std::byte>(i * 7);
    }
    return ByteString{content};
}

/// Sends `body` from client to server and back; what arrives must be what was sent.
void exchange(ChannelPair& pair, const ByteString& body)
{
    const auto write = [&](binary::Writer& writer) { writer.bytes(body.span()); };
    const auto id = pair.client.send(write);
    REQUIRE(id);
    pair.run();
    const ChannelEvent* request = ChannelPair::find(pair.server_events, Kind::Message);
    REQUIRE(request != nullptr);
    CHECK(request->request_id == *id);
    CHECK(ByteString{request->body} == body);
    REQUIRE(pair.server.send(*id, write));
    pair.run();
    const ChannelEvent* response = ChannelPair::find(pair.client_events, Kind::Message);
    REQUIRE(response != nullptr);
    CHECK(response->request_id == *id);
    CHECK(ByteString{response->body} == body);
}

} // namespace

TEST_CASE("a channel opens and carries messages of any size", "[channel]")
{
    const Way way = GENERATE(Way::InPlace, Way::Worker);
    for (const auto& security : all_settings()) {
        INFO(security.policy->name << " " << static_cast<int>(security.mode));
        ChannelPair pair{security, {}, {}, way};
        pair.run();
        REQUIRE(pair.server.is_open());
        REQUIRE(pair.client.is_open());
        CHECK(pair.client.channel_id() == 77);
        CHECK(pair.server.security() == security);
        CHECK(pair.server.endpoint_url() == "opc.tcp://localhost:4840");
        CHECK(pair.server.peer_certificates().size() == (security.policy->is_none() ? 0U : 1U));
        for (const std::size_t size : {1U, 15U, 16U, 17U, 65'000U, 65'535U, 300'000U}) {
            exchange(pair, bytes(size));
        }
    }
}

TEST_CASE("every body size around a block fits its padding", "[channel]")
{
    ChannelPair pair{setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt)};
    pair.run();
    for (std::size_t size = 1; size < 64; ++size) {
        exchange(pair, bytes(size));
    }
    for (std::size_t size = 65'400; size < 65'500; size += 3) {
        exchange(pair, bytes(size));
    }
}

TEST_CASE("bytes may come one at a time", "[channel]")
{
    const Way way = GENERATE(Way::InPlace, Way::Worker);
    ChannelPair pair{setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt), {}, {}, way};
    pair.run(1);
    REQUIRE(pair.client.is_open());
    const auto body = bytes(2'000);
    REQUIRE(pair.client.send([&](binary::Writer& writer) { writer.bytes(body.span()); }));
    pair.run(1);
    const ChannelEvent* request = ChannelPair::find(pair.server_events, Kind::Message);
    REQUIRE(request != nullptr);
    CHECK(ByteString{request->body} == body);
}

TEST_CASE("a message that does not fit leaves the channel as it was", "[channel]")
{
    channel::TransportLimits small;
    small.max_message_size = 100'000;
    ChannelPair pair{setting("Basic256Sha256", MessageSecurityMode::Sign), {}, small};
    pair.run();
    const auto large = bytes(100'001);
    const auto sent =
        pair.server.send(5, [&](binary::Writer& writer) { writer.bytes(large.span()); });
    REQUIRE_FALSE(sent);
    CHECK(sent.error() == status::Bad_ResponseTooLarge);
    CHECK(pair.server.output().empty());
    const auto failed = pair.server.send(6, [&](binary::Writer& writer) {
        writer.bytes(bytes(90'000).span());
        writer.fail(status::Bad_EncodingError);
    });
    CHECK(failed.error() == status::Bad_EncodingError);
    CHECK(pair.server.output().empty());
    exchange(pair, bytes(99'999));
}

TEST_CASE("a client refuses to send more than the server takes", "[channel]")
{
    channel::TransportLimits small;
    small.max_message_size = 20'000;
    ChannelPair pair{{}, small};
    pair.run();
    const auto large = bytes(20'001);
    const auto sent = pair.client.send([&](binary::Writer& writer) { writer.bytes(large.span()); });
    REQUIRE_FALSE(sent);
    CHECK(sent.error() == status::Bad_RequestTooLarge);
    exchange(pair, bytes(20'000));
}

TEST_CASE("chunks keep to the smaller buffer of both sides", "[channel]")
{
    channel::TransportLimits small;
    small.receive_buffer_size = 8'192;
    ChannelPair pair{setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt), small};
    pair.run();
    exchange(pair, bytes(50'000));
}

TEST_CASE("a SecurityToken is renewed before it expires", "[channel]")
{
    const Way way = GENERATE(Way::InPlace, Way::Worker);
    ChannelPair pair{setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt), {}, {}, way};
    pair.run();
    for (int i = 0; i < 5; ++i) {
        pair.advance(std::chrono::seconds{46});
        REQUIRE(pair.client.is_open());
        exchange(pair, bytes(100));
    }
    const auto renewals =
        std::count_if(pair.server_events.begin(), pair.server_events.end(),
                      [](const ChannelEvent& e) { return e.kind == Kind::Renewed; });
    CHECK(renewals == 5);
}

TEST_CASE("the server sends under the old token until the client used the new one", "[channel]")
{
    const Way way = GENERATE(Way::InPlace, Way::Worker);
    ChannelPair pair{setting("Basic256Sha256", MessageSecurityMode::Sign), {}, {}, way};
    pair.run();
    REQUIRE(pair.client.send([](binary::Writer& writer) { writer.number(1); }));
    pair.run();
    pair.now += std::chrono::seconds{46};
    pair.client.handle_deadline(pair.now);
    pair.run_to_server();
    // The response to the renewal and one more response are on their way together.
    REQUIRE(pair.server.send(2, [](binary::Writer& writer) { writer.number(2); }));
    pair.run();
    CHECK(pair.client.is_open());
    CHECK(ChannelPair::find(pair.client_events, Kind::Message) != nullptr);
    CHECK(ChannelPair::find(pair.client_events, Kind::Renewed) != nullptr);
    exchange(pair, bytes(10));
}

TEST_CASE("a channel whose token was not renewed ends", "[channel]")
{
    ChannelPair pair{setting("Basic256Sha256", MessageSecurityMode::Sign)};
    pair.run();
    CHECK(pair.server.next_deadline() == pair.now + std::chrono::seconds{75});
    pair.server.handle_deadline(pair.now + std::chrono::seconds{74});
    CHECK(pair.server.is_open());
    pair.server.handle_deadline(pair.now + std::chrono::seconds{75});
    CHECK(pair.server.is_closed());
}

TEST_CASE("CloseSecureChannel ends both sides without an error", "[channel]")
{
    ChannelPair pair{setting("Aes256_Sha256_RsaPss", MessageSecurityMode::SignAndEncrypt)};
    pair.run();
    pair.client.close();
    pair.run();
    const ChannelEvent* closed = ChannelPair::find(pair.server_events, Kind::Closed);
    REQUIRE(closed != nullptr);
    CHECK(closed->status == StatusCode{});
    CHECK(pair.server.output().empty());
}

TEST_CASE("a reverse connection begins with the server", "[channel]")
{
    ChannelPair pair;
    channel::ClientChannelConfig config;
    config.is_reverse = true;
    pair.client = channel::ClientChannel{config,
                                         {.random = &pair.random,
                                          .wall_clock = &pair.wall_clock,
                                          .log = &pair.log,
                                          .validator = &pair.validator},
                                         pair.now};
    CHECK(pair.client.output().empty());
    REQUIRE(pair.server.reverse_hello("urn:server", "opc.tcp://plc:4840"));
    pair.run();
    CHECK(pair.client.is_open());
    CHECK(pair.server.endpoint_url() == "opc.tcp://plc:4840");
}

} // namespace channel_test

#include <catch2/catch.hpp>

#include <functional>

#include <busbar/types/secure_channel.hpp>

#include "support/channel_pair.hpp"

namespace hostile_peer_test {

using namespace busbar;
using namespace busbar::test;
using Kind = channel::ChannelEvent::Kind;

namespace {

using Bytes = std::vector<std::byte>;

Bytes from_hex(std::string_view hex)
{
    Bytes bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes.push_back(
            static_cast<std::byte>(std::stoi(std::string{hex.substr(i, 2)}, nullptr, 16)));
    }
    return bytes;
}

/// The status in the Error message that the server answered with; Good if it sent none.
StatusCode error_of(channel::ServerChannel& server)
{
    while (server.next_event()) {
    }
    const auto out = server.output();
    binary::Reader reader{out};
    while (reader.remaining() >= 16) {
        const auto type = reader.bytes(4);
        const auto size = reader.number<std::uint32_t>();
        if (type[0] == std::byte{'E'}) {
            return StatusCode{reader.number<std::uint32_t>()};
        }
        reader.skip(size - 8);
    }
    return {};
}

StatusCode answer_to(const Bytes& input)
{
    ChannelPair pair;
    static_cast<void>(pair.server.feed(input, pair.now));
    const StatusCode error = error_of(pair.server);
    CHECK(pair.server.is_closed() == error.is_bad());
    return error;
}

Bytes hello(std::uint32_t receive, std::uint32_t send, std::size_t url_size)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.bytes(std::as_bytes(std::span{"HELF", 4}));
    writer.number(static_cast<std::uint32_t>(32 + url_size));
    for (const std::uint32_t number : {0U, receive, send, 0U, 0U}) {
        writer.number(number);
    }
    encode(writer, String{std::string(url_size, 'x')});
    return sink.take(writer.written());
}

/// Feeds an open server channel with a message of the client that was changed on the way.
StatusCode answer_to_changed(const channel::SecuritySetting& security,
                             const std::function<void(Bytes&)>& change)
{
    ChannelPair pair{security};
    pair.run();
    REQUIRE(pair.client.send([](binary::Writer& writer) { writer.number(std::uint64_t{7}); }));
    Bytes message = take_output(pair.client);
    change(message);
    static_cast<void>(pair.server.feed(message, pair.now));
    return error_of(pair.server);
}

} // namespace

TEST_CASE("what is no message header is answered with Error", "[channel][hostile]")
{
    // Sizes below the header, absurd sizes, unknown types and flags.
    for (const char* hex : {"4f504e4600000000", "48454c4607000000", "4d53474300000000"}) {
        CHECK(answer_to(from_hex(hex)) == status::Bad_TcpMessageTypeInvalid);
    }
    CHECK(answer_to(from_hex("4d534743ffffff7f")) == status::Bad_TcpMessageTooLarge);
    CHECK(answer_to(from_hex("48454c4600001000")) == status::Bad_TcpMessageTooLarge);
    for (const char* hex : {"58595a4610000000", "6d73674610000000", "4d53475a10000000",
                            "48454c4310000000", "474554202f204854"}) {
        CHECK(answer_to(from_hex(hex)) == status::Bad_TcpMessageTypeInvalid);
    }
}

TEST_CASE("messages that do not belong to the state are refused", "[channel][hostile]")
{
    for (const char* type :
         {"41434b46", "45525246", "52484546", "4f504e46", "4d534746", "434c4f46"}) {
        CHECK(answer_to(from_hex(std::string{type} + "1000000000000000" + "00000000")) ==
              status::Bad_TcpMessageTypeInvalid);
    }
    Bytes twice = hello(65'535, 65'535, 10);
    const Bytes again = twice;
    twice.insert(twice.end(), again.begin(), again.end());
    CHECK(answer_to(twice) == status::Bad_TcpMessageTypeInvalid);
}

TEST_CASE("a Hello is held to the specification's bounds", "[channel][hostile]")
{
    CHECK(answer_to(hello(8'192, 8'192, 0)).is_good());
    CHECK(answer_to(hello(0xFFFFFFFFU, 0xFFFFFFFFU, 4'096)).is_good());
    CHECK(answer_to(hello(65'535, 65'535, 4'097)) == status::Bad_TcpEndpointUrlInvalid);
    for (const std::uint32_t size : {0U, 1U, 1'023U, 8'191U}) {
        CHECK(answer_to(hello(size, 65'535, 5)) == status::Bad_TcpNotEnoughResources);
        CHECK(answer_to(hello(65'535, size, 5)) == status::Bad_TcpNotEnoughResources);
    }
    Bytes trailing = hello(65'535, 65'535, 5);
    trailing[4] = static_cast<std::byte>(std::to_integer<unsigned>(trailing[4]) + 2);
    trailing.resize(trailing.size() + 2);
    CHECK(answer_to(trailing) == status::Bad_TcpInternalError);
}

TEST_CASE("silence ends a connection", "[channel][hostile]")
{
    ChannelPair pair;
    pair.server.handle_deadline(pair.now + std::chrono::seconds{9});
    CHECK_FALSE(pair.server.is_closed());
    pair.server.handle_deadline(pair.now + std::chrono::seconds{10});
    CHECK(pair.server.is_closed());
    ChannelPair half;
    carry(half.client, half.server, half.now);
    while (half.server.next_event()) {
    }
    half.server.handle_deadline(half.now + std::chrono::seconds{10});
    CHECK(half.server.is_closed());
}

TEST_CASE("a flood of chunks without an end is cut off", "[channel][hostile]")
{
    channel::TransportLimits limits;
    limits.max_chunk_count = 4;
    ChannelPair pair{{}, limits};
    pair.run();
    const Bytes chunk = from_hex("4d5347431c0000004d00000001000000");
    for (std::uint32_t i = 0; i < 5; ++i) {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        writer.bytes(chunk);
        writer.number(std::uint32_t{2 + i});
        writer.number(std::uint32_t{9});
        writer.number(std::uint32_t{0});
        CHECK_FALSE(pair.server.is_closed());
        static_cast<void>(pair.server.feed(sink.take(writer.written()), pair.now));
        while (pair.server.next_event()) {
        }
    }
    CHECK(error_of(pair.server) == status::Bad_TcpMessageTooLarge);
}

TEST_CASE("every changed byte of a secured chunk is noticed",
          "[channel][hostile][unit:Security Signing Required]")
{
    for (const auto mode : {MessageSecurityMode::Sign, MessageSecurityMode::SignAndEncrypt}) {
        const auto security = setting("Basic256Sha256", mode);
        std::size_t size = 0;
        static_cast<void>(
            answer_to_changed(security, [&](Bytes& message) { size = message.size(); }));
        for (std::size_t i = 8; i < size; ++i) {
            INFO("byte " << i);
            const StatusCode error =
                answer_to_changed(security, [&](Bytes& m) { m[i] ^= std::byte{0x10}; });
            const StatusCode expected = i < 12   ? status::Bad_TcpSecureChannelUnknown
                                        : i < 16 ? status::Bad_SecureChannelTokenUnknown
                                                 : status::Bad_SecurityChecksFailed;
            CHECK(error == expected);
        }
    }
}

TEST_CASE("a shortened secured chunk is refused at every length", "[channel][hostile]")
{
    const auto security = setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);
    for (std::size_t size = 16; size < 80; ++size) {
        const StatusCode error = answer_to_changed(security, [&](Bytes& message) {
            message.resize(size);
            message[4] = static_cast<std::byte>(size);
        });
        CHECK(error == status::Bad_SecurityChecksFailed);
    }
}

TEST_CASE("a replayed chunk is refused", "[channel][hostile]")
{
    for (const auto& security :
         {channel::SecuritySetting{}, setting("Basic256Sha256", MessageSecurityMode::Sign)}) {
        const StatusCode error = answer_to_changed(security, [](Bytes& message) {
            const Bytes copy = message;
            message.insert(message.end(), copy.begin(), copy.end());
        });
        CHECK(error == status::Bad_SecurityChecksFailed);
    }
}

TEST_CASE("an OpenSecureChannel that was changed on its way is refused", "[channel][hostile]")
{
    const auto security = setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);
    std::size_t size = 0;
    const auto answer = [&](std::size_t at) {
        ChannelPair pair{security};
        carry(pair.client, pair.server, pair.now);
        while (pair.server.next_event()) {
        }
        carry(pair.server, pair.client, pair.now);
        while (pair.client.next_event()) {
        }
        Bytes open = take_output(pair.client);
        size = open.size();
        open[at] ^= std::byte{1};
        static_cast<void>(pair.server.feed(open, pair.now));
        const StatusCode error = error_of(pair.server);
        CHECK_FALSE(pair.server.is_open());
        return error;
    };
    static_cast<void>(answer(60));
    for (std::size_t at = 80; at < size; at += 37) {
        INFO("byte " << at << " of " << size);
        CHECK(answer(at) == status::Bad_SecurityChecksFailed);
    }
}

TEST_CASE("what is not allowed is not opened", "[channel][hostile]")
{
    ChannelPair pair{setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt)};
    channel::ClientChannelConfig config;
    config.endpoint_url = "opc.tcp://localhost:4840";
    pair.client = channel::ClientChannel{config,
                                         {.random = &pair.random,
                                          .wall_clock = &pair.wall_clock,
                                          .log = &pair.log,
                                          .validator = &pair.validator},
                                         pair.now};
    pair.run();
    CHECK_FALSE(pair.client.is_open());
    const auto* closed = ChannelPair::find(pair.client_events, Kind::Closed);
    REQUIRE(closed != nullptr);
    CHECK(closed->status == status::Bad_SecurityPolicyRejected);
}

TEST_CASE("a second Issue on an open channel is refused", "[channel][hostile]")
{
    ChannelPair pair;
    const Bytes first = take_output(pair.client);
    static_cast<void>(pair.server.feed(first, pair.now));
    while (pair.server.next_event()) {
    }
    carry(pair.server, pair.client, pair.now);
    while (pair.client.next_event()) {
    }
    Bytes open = take_output(pair.client);
    static_cast<void>(pair.server.feed(open, pair.now));
    while (pair.server.next_event()) {
    }
    REQUIRE(pair.server.is_open());
    open[8] = std::byte{77};
    // The same message again, for the open channel and with the next sequence number.
    binary::Reader reader{open};
    reader.skip(12 + 4 + 47 + 8);
    const std::size_t at = reader.offset();
    open[at] = static_cast<std::byte>(std::to_integer<unsigned>(open[at]) + 1);
    static_cast<void>(pair.server.feed(open, pair.now));
    CHECK(error_of(pair.server) == status::Bad_RequestTypeInvalid);
}

TEST_CASE("hostile lengths in certificates end at once", "[channel][hostile]")
{
    // A chain whose DER lengths wrap, are indefinite or lie.
    for (const char* der : {"3084fffffffa00", "3080000000", "308500000000ff", "308400000000", "30",
                            "3082ffff00", "020101"}) {
        INFO(der);
        CHECK_FALSE(crypto::parse_chain(from_hex(der)));
    }
}

TEST_CASE("a message that is given up is dropped and the channel lives", "[channel][hostile]")
{
    ChannelPair pair;
    pair.run();
    const auto feed = [&](const char* flag, std::uint32_t sequence, std::string_view body) {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        writer.bytes(std::as_bytes(std::span{"MSG", 3}));
        writer.number(flag[0]);
        writer.number(static_cast<std::uint32_t>(24 + body.size()));
        for (const std::uint32_t number : {77U, 1U, sequence, 9U}) {
            writer.number(number);
        }
        writer.bytes(std::as_bytes(std::span{body}));
        static_cast<void>(pair.server.feed(sink.take(writer.written()), pair.now));
        pair.run();
    };
    feed("C", 2, "some");
    feed("A", 3, std::string_view{"\0\0\x07\x80\xff\xff\xff\xff", 8});
    CHECK(ChannelPair::find(pair.server_events, Kind::Message) == nullptr);
    feed("F", 4, "whole");
    REQUIRE(ChannelPair::find(pair.server_events, Kind::Message) != nullptr);
    CHECK(ChannelPair::find(pair.server_events, Kind::Message)->body.size() == 5);
    feed("A", 5, "");
    CHECK(pair.server.is_closed());
}

} // namespace hostile_peer_test

#include <catch2/catch.hpp>

#include <busbar/types/secure_channel.hpp>

#include "channel/conversation.hpp"
#include "support/channel_pair.hpp"

namespace hostile_server_test {

using namespace busbar;
using namespace busbar::test;
using namespace busbar::channel::detail;
using Kind = channel::ChannelEvent::Kind;
using Bytes = std::vector<std::byte>;

namespace {

/// A client whose server sends what the test writes.
struct Client {
    explicit Client(channel::SecuritySetting security = {}, bool is_reverse = false)
        : engine{config(security, is_reverse),
                 {.random = &random,
                  .wall_clock = &wall_clock,
                  .log = &log,
                  .validator = &validator,
                  .identity = &client_identity()},
                 {}}
    {
    }

    void feed(const Bytes& bytes)
    {
        static_cast<void>(engine.feed(bytes, now));
        while (auto event = engine.next_event()) {
            events.push_back(*std::move(event));
        }
    }
    void acknowledge(std::uint32_t receive = 65'535, std::uint32_t send = 65'535)
    {
        OutputBuffer out;
        write_acknowledge(out, {0, receive, send, 0, 0, {}});
        feed({out.output().begin(), out.output().end()});
    }
    /// Answers the OPN that is on its way with `structure`.
    template <typename T>
    void answer(const T& structure, std::uint32_t request_id = 1)
    {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        encode_message(writer, structure);
        const Bytes body = sink.take(writer.written());
        const bool is_none = engine.security().policy->is_none();
        OutputBuffer out;
        REQUIRE(
            seal_asymmetric(out,
                            {77, engine.security().policy, is_none ? nullptr : &server_identity(),
                             is_none ? nullptr : &client_identity().certificates.front(),
                             ++sequence, request_id, body},
                            65'535));
        feed({out.output().begin(), out.output().end()});
    }
    void message(std::string_view type_and_flag, std::uint32_t request_id, const Bytes& body)
    {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        writer.bytes(std::as_bytes(std::span{type_and_flag}));
        writer.number(static_cast<std::uint32_t>(24 + body.size()));
        for (const std::uint32_t number : {77U, 5U, ++sequence, request_id}) {
            writer.number(number);
        }
        writer.bytes(body);
        feed(sink.take(writer.written()));
    }
    [[nodiscard]] StatusCode reason() const
    {
        return events.empty() ? StatusCode{} : events.back().status;
    }

    SeededRandom random;
    FixedWallClock wall_clock;
    LogBook log;
    crypto::InsecureAcceptAnyCertificate validator;
    TimePoint now{};
    std::uint32_t sequence{0};
    std::vector<channel::ChannelEvent> events;
    channel::ClientChannel engine;

private:
    [[nodiscard]] static channel::ClientChannelConfig config(channel::SecuritySetting security,
                                                             bool is_reverse)
    {
        channel::ClientChannelConfig config;
        config.endpoint_url = "opc.tcp://localhost:4840";
        config.security = security;
        config.server_certificate = server_identity().certificates.front();
        config.is_reverse = is_reverse;
        config.expected_server_uri = "urn:plc";
        return config;
    }
};

OpenSecureChannelResponse response(std::size_t nonce_size = 0)
{
    OpenSecureChannelResponse answer;
    answer.security_token.channel_id = 77;
    answer.security_token.token_id = 5;
    answer.security_token.revised_lifetime = 60'000;
    answer.server_nonce = ByteString{Bytes(nonce_size, std::byte{8})};
    return answer;
}

/// A client with an open channel of policy None.
struct OpenClient : Client {
    OpenClient()
    {
        acknowledge();
        answer(response());
        REQUIRE(engine.is_open());
        engine.consume(engine.output().size());
        events.clear();
    }
};

Bytes reverse_hello(std::string_view uri, std::string_view url)
{
    OutputBuffer out;
    write_reverse_hello(out, uri, url);
    return {out.output().begin(), out.output().end()};
}

} // namespace

TEST_CASE("an Acknowledge below the smallest buffers ends the connection", "[channel][client]")
{
    for (const std::uint32_t size : {0U, 1'024U, 8'191U}) {
        Client client;
        client.acknowledge(size, 65'535);
        CHECK(client.engine.is_closed());
        Client other;
        other.acknowledge(65'535, size);
        CHECK(other.engine.is_closed());
    }
    Client client;
    client.acknowledge(~0U, ~0U);
    CHECK_FALSE(client.engine.is_closed());
    client.acknowledge();
    CHECK(client.reason() == status::Bad_TcpMessageTypeInvalid);
}

TEST_CASE("an Error from the server is handed on", "[channel][client]")
{
    for (const std::size_t size : {std::size_t{5}, std::size_t{4'097}}) {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        writer.bytes(std::as_bytes(std::span{"ERRF", 4}));
        writer.number(static_cast<std::uint32_t>(16 + size));
        encode(writer, status::Bad_TcpServerTooBusy);
        encode(writer, String{std::string(size, '\n')});
        Client client;
        client.feed(sink.take(writer.written()));
        REQUIRE(client.reason() == status::Bad_TcpServerTooBusy);
        CHECK(client.events.back().reason.find('\n') == std::string::npos);
    }
}

TEST_CASE("a server may answer the request to open with a fault", "[channel][client]")
{
    Client client;
    client.acknowledge();
    ServiceFault fault;
    fault.response_header.service_result = status::Bad_SecurityModeRejected;
    client.answer(fault);
    CHECK(client.reason() == status::Bad_SecurityModeRejected);
}

TEST_CASE("a server's token is checked before it is used", "[channel][client]")
{
    const auto secured = setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);
    for (const std::size_t size : {0U, 16U, 31U, 33U}) {
        Client client{secured};
        client.acknowledge();
        client.answer(response(size));
        CHECK(client.reason() == status::Bad_NonceInvalid);
    }
    Client good{secured};
    good.acknowledge();
    good.answer(response(32));
    CHECK(good.engine.is_open());
    Client wrong_request;
    wrong_request.acknowledge();
    wrong_request.answer(response(), 9);
    CHECK(wrong_request.reason() == status::Bad_SecurityChecksFailed);
    Client unasked;
    unasked.acknowledge();
    unasked.answer(response());
    unasked.answer(response(), 0);
    CHECK(unasked.engine.is_closed());
}

TEST_CASE("a lifetime of nothing does not make the client ask without end", "[channel][client]")
{
    Client client;
    client.acknowledge();
    auto answer = response();
    answer.security_token.revised_lifetime = 0;
    client.answer(answer);
    REQUIRE(client.engine.is_open());
    CHECK(client.engine.next_deadline() >= client.now + std::chrono::milliseconds{500});
}

TEST_CASE("an aborted response reaches the caller, even one without chunks", "[channel][client]")
{
    OpenClient client;
    client.message("MSGC", 4, Bytes(10));
    client.message("MSGA", 4,
                   Bytes{std::byte{0}, std::byte{0}, std::byte{0xB9}, std::byte{0x80},
                         std::byte{0xFF}, std::byte{0xFF}, std::byte{0xFF}, std::byte{0xFF}});
    REQUIRE(client.events.size() == 1);
    CHECK(client.events[0].kind == Kind::Aborted);
    CHECK(client.events[0].request_id == 4);
    CHECK(client.events[0].status == status::Bad_ResponseTooLarge);
    client.message("MSGA", 5, {}); // without a body
    REQUIRE(client.events.size() == 2);
    CHECK(client.events[1].status == status::Bad_DecodingError);
    client.message("MSGF", 6, Bytes(3));
    CHECK(client.events.back().kind == Kind::Message);
    CHECK(client.engine.is_open());
}

TEST_CASE("an abort is an error even if it says Good", "[channel][client]")
{
    OpenClient client;
    client.message("MSGA", 4, Bytes(8)); // Good, and an empty text
    REQUIRE(client.events.size() == 1);
    CHECK(client.events[0].kind == Kind::Aborted);
    CHECK(client.events[0].status == status::Bad_DecodingError);
    CHECK(client.engine.is_open());
}

TEST_CASE("a client that gives up says CloseSecureChannel", "[channel][client]")
{
    OpenClient client;
    client.sequence += 5;
    client.message("MSGF", 6, Bytes(3));
    CHECK(client.reason() == status::Bad_SequenceNumberInvalid);
    const auto out = take_output(client.engine);
    REQUIRE(out.size() > 8);
    CHECK(out[0] == std::byte{'C'});
}

TEST_CASE("a ReverseHello must come from the expected server", "[channel][client]")
{
    Client good{{}, true};
    CHECK(good.engine.output().empty());
    good.feed(reverse_hello("urn:plc", "opc.tcp://plc:4840"));
    CHECK(good.engine.endpoint_url() == "opc.tcp://plc:4840");
    CHECK(take_output(good.engine)[0] == std::byte{'H'});
    Bytes too_long = reverse_hello("urn:plc", std::string(4'096, 'x'));
    too_long[4] = static_cast<std::byte>(std::to_integer<unsigned>(too_long[4]) + 1);
    too_long[19] = static_cast<std::byte>(std::to_integer<unsigned>(too_long[19]) + 1);
    too_long.push_back(std::byte{'x'});
    for (const Bytes& bytes : {reverse_hello("urn:evil", "opc.tcp://plc:4840"), too_long}) {
        Client client{{}, true};
        client.feed(bytes);
        CHECK(client.reason() == status::Bad_TcpEndpointUrlInvalid);
        CHECK(take_output(client.engine)[0] == std::byte{'E'});
    }
    Client late{{}, true};
    late.engine.handle_deadline(late.engine.next_deadline());
    CHECK(late.engine.is_closed());
}

TEST_CASE("a client trusts nobody without a validator", "[channel][client]")
{
    Client client;
    channel::ClientChannelConfig config;
    config.security = setting("Basic256Sha256", MessageSecurityMode::Sign);
    config.server_certificate = server_identity().certificates.front();
    channel::ClientChannel blind{config,
                                 {.random = &client.random,
                                  .wall_clock = &client.wall_clock,
                                  .log = &client.log,
                                  .identity = &client_identity()},
                                 client.now};
    CHECK(blind.is_closed());
    CHECK(blind.output().empty());
}

TEST_CASE("a client connects with a deprecated policy under protest", "[channel][client]")
{
    auto policy = *crypto::find_policy_by_name("Basic256Sha256");
    const Client good{{&policy, MessageSecurityMode::Sign}};
    CHECK(good.log.text.empty());
    policy.is_deprecated = true;
    const Client deprecated{{&policy, MessageSecurityMode::Sign}};
    CHECK(deprecated.log.text.find("INSECURE: connecting with Basic256Sha256") !=
          std::string::npos);
}

} // namespace hostile_server_test

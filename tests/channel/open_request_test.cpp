#include <catch2/catch.hpp>

#include "support/scripted_client.hpp"

namespace open_request_test {

using namespace busbar;
using namespace busbar::test;
using Bytes = ScriptedClient::Bytes;
using Open = ScriptedClient::Open;

namespace {

const channel::SecuritySetting none{};

channel::SecuritySetting secured(MessageSecurityMode mode = MessageSecurityMode::SignAndEncrypt)
{
    return setting("Basic256Sha256", mode);
}

Open open_with(const channel::SecuritySetting& security)
{
    Open open;
    open.security = security;
    return open;
}

Open renewal_of(const channel::SecuritySetting& security)
{
    Open open = open_with(security);
    open.channel_id = ScriptedClient::channel_id;
    open.type = SecurityTokenRequestType::Renew;
    open.nonce_fill = 2;
    return open;
}

/// An OPN of policy Basic256Sha256 with these header fields and junk behind them.
Bytes with_header(std::optional<Bytes> certificate, std::optional<Bytes> thumbprint)
{
    const auto field = [](const std::optional<Bytes>& bytes) {
        return bytes ? ByteString{*bytes} : ByteString{};
    };
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.number(std::uint32_t{0});
    encode(writer, String{secured().policy->uri});
    encode(writer, field(certificate));
    encode(writer, field(thumbprint));
    writer.bytes(Bytes(256));
    const Bytes rest = sink.take(writer.written());
    Bytes message(8);
    message.insert(message.end(), rest.begin(), rest.end());
    channel::detail::write_frame_header(message, {channel::detail::MessageType::OPN, 'F',
                                                  static_cast<std::uint32_t>(message.size())});
    return message;
}

/// A server that got this one OPN.
struct Attempt {
    Attempt(const channel::SecuritySetting& allowed, const Open& open) : client{{allowed}}
    {
        client.feed(client.open_message(open));
    }

    ScriptedClient client;
};

} // namespace

TEST_CASE("a request to open is answered", "[channel][open]")
{
    for (const auto& security : {none, secured(), secured(MessageSecurityMode::Sign)}) {
        Attempt attempt{security, open_with(security)};
        CHECK(attempt.client.server.is_open());
        CHECK(attempt.client.server.security() == security);
    }
}

TEST_CASE("a request to open is all of its message, and all of it is there", "[channel][open]")
{
    for (const std::ptrdiff_t surplus : {-36, -5, -1, 1, 4}) {
        CAPTURE(surplus);
        Open open = open_with(none);
        open.surplus = surplus;
        const Attempt attempt{none, open};
        CHECK_FALSE(attempt.client.server.is_open());
        CHECK(attempt.client.reason() == status::Bad_DecodingError);
        CHECK(attempt.client.told() == status::Bad_SecurityChecksFailed);
    }
}

TEST_CASE("a nonce must have the policy's length",
          "[channel][open][unit:EphemeralKeyAlgorithm_None]")
{
    for (const std::size_t size : {0U, 1U, 16U, 31U, 33U, 64U}) {
        Open open = open_with(secured());
        open.nonce_size = size;
        const Attempt attempt{secured(), open};
        CHECK(attempt.client.told() == status::Bad_SecurityChecksFailed);
        CHECK(attempt.client.reason() == status::Bad_NonceInvalid);
    }
}

TEST_CASE("mode and policy must be offered and belong together",
          "[channel][open][unit:Security Encryption Required]"
          "[unit:Security Signing Required]")
{
    for (const auto mode : {MessageSecurityMode{0}, MessageSecurityMode{4},
                            MessageSecurityMode::Sign, MessageSecurityMode::None}) {
        const Attempt attempt{secured(), open_with({secured().policy, mode})};
        CHECK(attempt.client.told() == status::Bad_SecurityModeRejected);
    }
    const Attempt signed_none{none, open_with({none.policy, MessageSecurityMode::Sign})};
    CHECK(signed_none.client.told() == status::Bad_SecurityModeRejected);
    const Attempt not_offered{secured(), open_with(none)};
    CHECK(not_offered.client.told() == status::Bad_SecurityPolicyRejected);
}

TEST_CASE("the type of request belongs to the state", "[channel][open]")
{
    Open early = open_with(none);
    early.type = SecurityTokenRequestType::Renew;
    const Attempt too_early{none, early};
    CHECK(too_early.client.told() == status::Bad_RequestTypeInvalid);
    for (const auto type : {SecurityTokenRequestType::Issue, SecurityTokenRequestType{2}}) {
        Attempt attempt{none, open_with(none)};
        Open second = renewal_of(none);
        second.type = type;
        attempt.client.feed(attempt.client.open_message(second));
        CHECK(attempt.client.told() == status::Bad_RequestTypeInvalid);
    }
}

TEST_CASE("a renewal keeps channel, policy, mode and certificate", "[channel][open]")
{
    const auto answer = [](const Open& renewal) {
        ScriptedClient client{{secured(), secured(MessageSecurityMode::Sign), none}};
        client.feed(client.open_message(open_with(secured())));
        REQUIRE(client.server.is_open());
        client.feed(client.open_message(renewal));
        return client.told();
    };
    CHECK(answer(renewal_of(secured())) == StatusCode{});
    CHECK(answer(renewal_of(secured(MessageSecurityMode::Sign))) ==
          status::Bad_SecurityModeRejected);
    CHECK(answer(renewal_of(none)) == status::Bad_SecurityChecksFailed);
    const auto stranger = make_identity("stranger");
    Open other = renewal_of(secured());
    other.sender = &stranger;
    CHECK(answer(other) == status::Bad_SecurityChecksFailed);
    Open repeated = renewal_of(secured());
    repeated.nonce_fill = 1;
    CHECK(answer(repeated) == status::Bad_SecurityChecksFailed);
    Open elsewhere = renewal_of(secured());
    elsewhere.channel_id = 78;
    CHECK(answer(elsewhere) == status::Bad_TcpSecureChannelUnknown);
}

TEST_CASE("renewals without end keep two tokens and no memory", "[channel][open]")
{
    ScriptedClient client{{none}};
    client.feed(client.open_message(open_with(none)));
    client.server.consume(client.server.output().size());
    const std::size_t before = client.server.memory_in_use();
    for (int i = 0; i < 2'000; ++i) {
        client.feed(client.open_message(renewal_of(none)));
        REQUIRE(client.server.is_open());
        client.server.consume(client.server.output().size());
    }
    CHECK(client.server.memory_in_use() <= before + 1'024);
    client.events.clear();
    client.feed(client.chunk("MSGF", 9, 4, 2'001)); // the newest
    CHECK(client.events.size() == 1);
    client.feed(client.chunk("MSGF", 10, 4, 2'000));
    CHECK(client.told() == status::Bad_SecureChannelTokenUnknown);
}

TEST_CASE("certificates that are none are refused", "[channel][open]")
{
    const auto own = server_identity().certificates.front().thumbprint();
    const auto leaf = client_identity().certificates.front().der();
    const Bytes good{leaf.begin(), leaf.end()};
    Bytes torn = good;
    torn.pop_back();
    const Bytes wrapping{std::byte{0x30}, std::byte{0x84}, std::byte{0xFF},
                         std::byte{0xFF}, std::byte{0xFF}, std::byte{0xFA}};
    for (const auto& certificate : std::vector<std::optional<Bytes>>{
             std::nullopt, Bytes{}, Bytes(1), Bytes(60'000), torn, wrapping, good}) {
        ScriptedClient client{{secured()}};
        client.feed(with_header(certificate, own));
        CHECK(client.told() == status::Bad_SecurityChecksFailed);
    }
    for (const auto& thumbprint :
         std::vector<std::optional<Bytes>>{std::nullopt, Bytes(19), Bytes(20), Bytes(21)}) {
        ScriptedClient client{{secured()}};
        client.feed(with_header(good, thumbprint));
        CHECK(client.told() == status::Bad_SecurityChecksFailed);
    }
}

TEST_CASE("the server's own certificate opens nothing", "[channel][open]")
{
    Open reflected = open_with(secured());
    reflected.sender = &server_identity();
    const Attempt attempt{secured(), reflected};
    CHECK(attempt.client.told() == status::Bad_SecurityChecksFailed);
    CHECK(attempt.client.reason() == status::Bad_CertificateUseNotAllowed);
}

TEST_CASE("whatever failed in security, the answer is the same bytes", "[channel][open]")
{
    std::vector<Bytes> answers;
    std::string logged;
    const auto keep = [&](const ScriptedClient& client) {
        answers.push_back(client.error());
        logged += client.log.text;
    };
    for (const std::size_t from_end : {1U, 300U}) { // in the second and in the first RSA block
        ScriptedClient client{{secured()}};
        Bytes message = client.open_message(open_with(secured()));
        message[message.size() - from_end] ^= std::byte{1};
        client.feed(message);
        keep(client);
    }
    for (const auto answer : {status::Bad_CertificateUntrusted, status::Bad_CertificateRevoked,
                              status::Bad_CertificateTimeInvalid}) {
        ScriptedClient client{{secured()}};
        client.validator.answer = answer;
        client.feed(client.open_message(open_with(secured())));
        keep(client);
    }
    const auto stranger = make_identity("another");
    Open foreign = open_with(secured());
    foreign.receiver = &stranger.certificates.front();
    keep(Attempt{secured(), foreign}.client);
    Open nonce = open_with(secured());
    nonce.nonce_size = 16;
    keep(Attempt{secured(), nonce}.client);
    for (const Bytes& answer : answers) {
        REQUIRE_FALSE(answer.empty());
        CHECK(answer == answers.front());
    }
    CHECK(logged.find("Bad_CertificateUntrusted") != std::string::npos);
    CHECK(logged.find("Bad_NonceInvalid") != std::string::npos);
}

TEST_CASE("who connects again with a trusted certificate is not parsed again", "[channel][open]")
{
    crypto::KnownCertificates known;
    const auto connect = [&](StatusCode judgement) {
        ScriptedClient client{{secured()}, {}, nullptr, &known};
        client.validator.answer = judgement;
        client.feed(client.open_message(open_with(secured())));
        return client.server.peer_certificates();
    };
    CHECK(connect(status::Bad_CertificateUntrusted).empty());
    CHECK(known.certificates().empty());
    const auto first = connect(status::Good);
    REQUIRE(first.size() == 1);
    const auto again = connect(status::Good);
    REQUIRE(again.size() == 1);
    CHECK(again.front().native() == first.front().native());
    // What is known is judged all the same.
    CHECK(connect(status::Bad_CertificateRevoked).empty());
    CHECK(connect(status::Good).size() == 1);
}

} // namespace open_request_test

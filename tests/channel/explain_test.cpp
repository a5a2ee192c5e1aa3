#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <string>

#include "support/scripted_client.hpp"

namespace explain_test {

using namespace busbar;
using namespace busbar::test;
using Bytes = ScriptedClient::Bytes;
using Open = ScriptedClient::Open;

namespace {

const auto encrypt = setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);

/// Lists what a peer does wrong and what the log has to say of it.
struct Row {
    std::string what;
    std::function<void(ScriptedClient&)> act;
    std::vector<std::string> said;
};

void open_with(ScriptedClient& client, const std::function<void(Open&)>& change)
{
    Open open;
    open.security = encrypt;
    change(open);
    client.feed(client.open_message(open));
}

const channel::ApplicationIdentity& stranger()
{
    static const auto identity = make_identity("stranger");
    return identity;
}

std::vector<Row> rows_before_opening()
{
    return {
        {"bytes that are no message",
         [](ScriptedClient& c) { c.feed(Bytes(8, std::byte{'x'})); },
         {"message type failed", "Bad_TcpMessageTypeInvalid", "Part 6, 7.1.2.2"}},
        {"a policy that is not offered",
         [](ScriptedClient& c) {
             open_with(c, [](Open& o) {
                 o.security = setting("Aes128_Sha256_RsaOaep", MessageSecurityMode::Sign);
             });
         },
         {"security policy failed", "Aes128_Sha256_RsaOaep is not offered here",
          "Bad_SecurityPolicyRejected", "add an endpoint"}},
        {"a mode that is not offered",
         [](ScriptedClient& c) {
             open_with(c, [](Open& o) { o.security.mode = MessageSecurityMode::Sign; });
         },
         {"security mode failed", "Sign with Basic256Sha256 is not offered here",
          "Bad_SecurityModeRejected", "Part 4, 5.6.2.2"}},
        {"a message for another certificate",
         [](ScriptedClient& c) {
             open_with(c, [](Open& o) { o.receiver = &stranger().certificates.front(); });
         },
         {"receiver certificate thumbprint failed", "Part 6, 6.7.2.3",
          server_identity().certificates.front().thumbprint_text(),
          "read this server's endpoints"}},
        {"a certificate that is not accepted",
         [](ScriptedClient& c) {
             c.validator.answer = status::Bad_CertificateUntrusted;
             open_with(c, [](Open&) {});
         },
         {"the validator's check failed", "Bad_CertificateUntrusted"}},
        {"a certificate whose key the peer has not",
         [](ScriptedClient& c) {
             channel::ApplicationIdentity thief{client_identity().certificates, stranger().key};
             open_with(c, [&](Open& o) { o.sender = &thief; });
         },
         {"OpenSecureChannel encryption and signature failed", "Bad_SecurityChecksFailed",
          "Part 6, 6.7.7", client_identity().certificates.front().thumbprint_text(),
          "Check that the peer's private key belongs to its certificate"}},
        {"a short nonce",
         [](ScriptedClient& c) { open_with(c, [](Open& o) { o.nonce_size = 16; }); },
         {"client nonce failed", "16 bytes where 32 new ones were expected", "Bad_NonceInvalid",
          "Part 6, 6.7.4"}},
        {"a renewal of nothing",
         [](ScriptedClient& c) {
             open_with(c, [](Open& o) { o.type = SecurityTokenRequestType::Renew; });
         },
         {"request type failed", "Renew without a channel", "Bad_RequestTypeInvalid"}},
        {"silence",
         [](ScriptedClient& c) { c.server.handle_deadline(c.now + std::chrono::seconds{11}); },
         {"handshake failed", "Bad_Timeout", "Part 6, 7.1.3"}},
    };
}

std::vector<Row> rows_on_an_open_channel()
{
    return {
        {"a token that was never issued",
         [](ScriptedClient& c) { c.feed(c.chunk("MSGF", 2, 8, 99)); },
         {"SecurityToken failed", "Bad_SecureChannelTokenUnknown"}},
        {"a repeated sequence number",
         [](ScriptedClient& c) {
             --c.sequence;
             c.feed(c.chunk("MSGF", 2, 8));
         },
         {"sequence number failed", "Bad_SequenceNumberInvalid", "Part 6, 6.7.2.4"}},
        {"a second Issue",
         [](ScriptedClient& c) {
             Open again;
             again.channel_id = ScriptedClient::channel_id;
             again.nonce_fill = 2;
             c.feed(c.open_message(again));
         },
         {"request type failed", "Issue on an open channel", "Part 4, 5.6.2.2"}},
        {"an abort of nothing",
         [](ScriptedClient& c) { c.feed(c.chunk("MSGA", 2, 8)); },
         {"message type failed", "Bad_TcpMessageTypeInvalid"}},
    };
}

void check(const Row& row, ScriptedClient& client)
{
    INFO(row.what);
    client.log.text.clear();
    row.act(client);
    const std::string& text = client.log.text;
    INFO(text);
    REQUIRE(client.server.is_closed());
    CHECK(std::count(text.begin(), text.end(), '\n') == 1);
    for (const std::string& part : row.said) {
        INFO(part);
        CHECK(text.find(part) != std::string::npos);
    }
}

} // namespace

TEST_CASE("the log says why a channel was not opened", "[channel][explain]")
{
    for (const Row& row : rows_before_opening()) {
        ScriptedClient client{{encrypt}};
        check(row, client);
    }
}

TEST_CASE("the log says why a channel was closed", "[channel][explain]")
{
    for (const Row& row : rows_on_an_open_channel()) {
        ScriptedClient client{{channel::SecuritySetting{}}};
        client.feed(client.open_message({}));
        REQUIRE(client.server.is_open());
        check(row, client);
    }
}

TEST_CASE("what the log knows the peer does not learn", "[channel][explain]")
{
    ScriptedClient client{{encrypt}};
    client.validator.answer = status::Bad_CertificateRevoked;
    open_with(client, [](Open&) {});
    CHECK(client.told() == status::Bad_SecurityChecksFailed);
    const Bytes error = client.error();
    const std::string told{reinterpret_cast<const char*>(error.data()), error.size()};
    CHECK(told.find("Revoked") == std::string::npos);
    CHECK(told.find("validator") == std::string::npos);
    CHECK(client.log.text.find("Bad_CertificateRevoked") != std::string::npos);
}

} // namespace explain_test

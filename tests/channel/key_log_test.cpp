#include <map>
#include <sstream>

#include <catch2/catch.hpp>

#include <openssl/evp.h>

#include "channel/frame.hpp"
#include "support/channel_pair.hpp"

namespace key_log_test {

using namespace busbar;
using namespace busbar::test;
using channel::SecuritySetting;
using Bytes = std::vector<std::byte>;

namespace {

class KeyBook final : public channel::KeyLog {
public:
    void write(std::string_view lines) override { text += lines; }

    std::string text;
};

/// Two ends that each have a key log.
struct Watched {
    explicit Watched(const SecuritySetting& security) : pair{security}
    {
        channel::ServerChannelConfig server;
        server.allowed = {security};
        server.channel_id = 4'000'000'077;
        channel::ChannelEnvironment environment{.random = &pair.random,
                                                .wall_clock = &pair.wall_clock,
                                                .log = &pair.log,
                                                .validator = &pair.validator,
                                                .identity = &server_identity()};
        environment.key_log = &server_keys;
        pair.server = channel::ServerChannel{server, environment, pair.now};
        channel::ClientChannelConfig client;
        client.security = security;
        client.server_certificate = server_identity().certificates.front();
        client.requested_lifetime = std::chrono::minutes{1};
        environment.identity = &client_identity();
        environment.key_log = &client_keys;
        pair.client = channel::ClientChannel{client, environment, pair.now};
        pair.run();
        REQUIRE(pair.client.is_open());
    }

    ChannelPair pair;
    KeyBook server_keys;
    KeyBook client_keys;
};

std::map<std::string, std::string> parsed(const std::string& text)
{
    std::map<std::string, std::string> values;
    std::istringstream lines{text};
    for (std::string line; std::getline(lines, line);) {
        const auto colon = line.find(": ");
        REQUIRE(colon != std::string::npos);
        REQUIRE(values.emplace(line.substr(0, colon), line.substr(colon + 2)).second);
    }
    return values;
}

std::vector<unsigned char> from_hex(const std::string& hex)
{
    std::vector<unsigned char> bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes.push_back(static_cast<unsigned char>(std::stoul(hex.substr(i, 2), nullptr, 16)));
    }
    return bytes;
}

/// The body of a MSG chunk as someone reads it who has the chunk and the key log, no more.
Bytes body_of(const Bytes& chunk, std::map<std::string, std::string>& keys, const std::string& end,
              const std::string& token)
{
    const auto key = from_hex(keys.at(end + "_key_" + token));
    const auto vector = from_hex(keys.at(end + "_iv_" + token));
    const std::size_t signature = std::stoul(keys.at(end + "_siglen_" + token));
    std::vector<unsigned char> text(chunk.size());
    EVP_CIPHER_CTX* const context = EVP_CIPHER_CTX_new();
    int size = 0;
    EVP_DecryptInit_ex(context, key.size() == 16 ? EVP_aes_128_cbc() : EVP_aes_256_cbc(), nullptr,
                       key.data(), vector.data());
    EVP_CIPHER_CTX_set_padding(context, 0);
    EVP_DecryptUpdate(context, text.data(), &size,
                      reinterpret_cast<const unsigned char*>(chunk.data()) + 16,
                      static_cast<int>(chunk.size()) - 16);
    EVP_CIPHER_CTX_free(context);
    const std::size_t end_of_text = static_cast<std::size_t>(size) - signature;
    const std::size_t padding = text[end_of_text - 1] + 1U;
    const auto body = std::as_bytes(std::span{text}.subspan(8, end_of_text - padding - 8));
    return {body.begin(), body.end()};
}

constexpr auto write_hello = [](binary::Writer& writer) {
    writer.bytes(std::as_bytes(std::span{"hello", 5}));
};
const Bytes hello{std::byte{'h'}, std::byte{'e'}, std::byte{'l'}, std::byte{'l'}, std::byte{'o'}};

} // namespace

TEST_CASE("with the key log a captured channel can be read", "[channel][keylog]")
{
    for (const auto& policy : crypto::security_policies().subspan(1)) {
        INFO(policy.name);
        Watched watched{{&policy, MessageSecurityMode::SignAndEncrypt}};
        ChannelPair& pair = watched.pair;
        CHECK(watched.server_keys.text == watched.client_keys.text);
        auto keys = parsed(watched.server_keys.text);
        CHECK(keys.size() == 6);
        CHECK(keys.at("client_iv_4000000077_1").size() == 32);
        CHECK(keys.at("client_key_4000000077_1").size() == 2 * policy.encrypting_key_size);
        CHECK(keys.at("server_siglen_4000000077_1") ==
              std::to_string(policy.symmetric_signature_size));
        const auto id = pair.client.send(write_hello);
        REQUIRE(id);
        CHECK(body_of(take_output(pair.client), keys, "client", "4000000077_1") == hello);
        REQUIRE(pair.server.send(*id, write_hello));
        CHECK(body_of(take_output(pair.server), keys, "server", "4000000077_1") == hello);
    }
}

TEST_CASE("every token's keys are in the key log", "[channel][keylog]")
{
    Watched watched{setting("Basic256Sha256", MessageSecurityMode::Sign)};
    CHECK(parsed(watched.client_keys.text).size() == 6);
    watched.pair.advance(std::chrono::seconds{46});
    auto keys = parsed(watched.client_keys.text);
    CHECK(keys.size() == 12);
    CHECK(keys.at("client_key_4000000077_1") != keys.at("client_key_4000000077_2"));
    CHECK(watched.server_keys.text == watched.client_keys.text);
    CHECK(watched.pair.log.text.find(keys.at("client_key_4000000077_1")) == std::string::npos);
}

TEST_CASE("a channel without security has no keys", "[channel][keylog]")
{
    const Watched watched{SecuritySetting{}};
    CHECK(watched.server_keys.text.empty());
    CHECK(watched.client_keys.text.empty());
}

} // namespace key_log_test

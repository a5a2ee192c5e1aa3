#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>

#include <busbar/channel/server_channel.hpp>
#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/types/secure_channel.hpp>

#include "channel/asymmetric_message.hpp"
#include "channel/conversation.hpp"
#include "fuzz_script.hpp"
#include "require.hpp"
#include "support/identity.hpp"
#include "support/seeded_random.hpp"

namespace open_text_fuzz {

using namespace busbar;
using namespace busbar::channel::detail;
using fuzz::require;
using Bytes = std::vector<std::byte>;
using Kind = channel::ChannelEvent::Kind;

namespace {

constexpr std::uint32_t channel_id = 77;

const crypto::SecurityPolicy& usual_policy()
{
    return *crypto::find_policy_by_name("Basic256Sha256");
}
/// Keys of 1024 bits, with which a private key works six times as fast as with 2048.
const crypto::SecurityPolicy& small_key_policy()
{
    static const crypto::SecurityPolicy policy = [] {
        auto copy = usual_policy();
        copy.min_key_bits = 1'024;
        return copy;
    }();
    return policy;
}

struct Keys {
    channel::ApplicationIdentity sender;
    channel::ApplicationIdentity receiver;
};
/// Also of sizes that PrivateKey does not make.
crypto::PrivateKey make_key(unsigned bits)
{
    EVP_PKEY* const made = EVP_RSA_gen(bits);
    BIO* const text = BIO_new(BIO_s_mem());
    require(made != nullptr && text != nullptr &&
            PEM_write_bio_PrivateKey(text, made, nullptr, nullptr, 0, nullptr, nullptr) == 1);
    const char* data = nullptr;
    const auto size = static_cast<std::size_t>(BIO_get_mem_data(text, &data));
    auto key = crypto::PrivateKey::parse(std::as_bytes(std::span{data, size}));
    BIO_free(text);
    EVP_PKEY_free(made);
    require(key.has_value());
    return *std::move(key);
}

// Keys are made once by each process; what an input does depends on their sizes alone.

channel::ApplicationIdentity make_identity(unsigned bits, const std::string& name)
{
    const crypto::PrivateKey key = make_key(bits);
    crypto::CertificateSubject subject;
    subject.common_name = name;
    subject.application_uri = "urn:busbar:test:" + name;
    subject.valid_from = test::today;
    const auto certificate = crypto::create_self_signed(key, subject);
    require(certificate.has_value());
    return {{*certificate}, key};
}
const Keys& small_keys()
{
    static const Keys keys{make_identity(1'024, "client"), make_identity(1'024, "server")};
    return keys;
}
const Keys& keys_of_large_padding()
{
    static const Keys keys{small_keys().sender, make_identity(2'056, "server")};
    return keys;
}
const Keys& usual_keys()
{
    static const Keys keys{test::client_identity(), test::server_identity()};
    return keys;
}

/// Everything before what is encrypted.
Bytes headers(const crypto::SecurityPolicy& policy, const Keys& keys)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.number(std::uint64_t{0});
    writer.number(std::uint32_t{0});
    encode(writer, String::borrow(policy.uri));
    encode(writer, ByteString::borrow(keys.sender.certificates.front().der()));
    encode(writer, ByteString{keys.receiver.certificates.front().thumbprint()});
    return sink.take(writer.written());
}

/// What fills `text` and a signature up to whole blocks, at least its own size's field, and `more`
/// blocks.
void pad(Bytes& text, const crypto::SecurityPolicy& policy, const Keys& keys, std::size_t more)
{
    const std::size_t key_size = keys.receiver.key.key_size();
    const std::size_t block = crypto::plain_block_size(policy, key_size);
    const std::size_t field = key_size > 256 ? 2 : 1;
    const std::size_t used = text.size() + field + keys.sender.key.key_size();
    const std::size_t count = (block - used % block) % block + more * block;
    text.insert(text.end(), count + 1, static_cast<std::byte>(count));
    if (field == 2) {
        text.push_back(static_cast<std::byte>(count >> 8U));
    }
}

/// The message with `text`, which fills whole blocks with the signature, signed and encrypted.
Bytes sealed(const crypto::SecurityPolicy& policy, const Keys& keys, const Bytes& text)
{
    Bytes message = headers(policy, keys);
    const std::size_t begin = message.size();
    const std::size_t plain = text.size() + keys.sender.key.key_size();
    const std::size_t key_size = keys.receiver.key.key_size();
    const std::size_t blocks = plain / crypto::plain_block_size(policy, key_size);
    message.insert(message.end(), text.begin(), text.end());
    write_frame_header(
        message, {MessageType::OPN, 'F', static_cast<std::uint32_t>(begin + blocks * key_size)});
    const auto signature = crypto::asymmetric_sign(policy, keys.sender.key, message);
    require(signature.has_value());
    message.insert(message.end(), signature->begin(), signature->end());
    const auto cipher = crypto::asymmetric_encrypt(policy, keys.receiver.certificates.front(),
                                                   std::span{message}.subspan(begin));
    require(cipher && cipher->size() == blocks * key_size);
    message.resize(begin);
    message.insert(message.end(), cipher->begin(), cipher->end());
    return message;
}

/// The text without its padding as Part 6, 6.7.2.5 has it; none if the padding is wrong.
std::optional<Bytes> unpadded(const Bytes& text, bool is_large)
{
    const std::size_t field = is_large ? 2 : 1;
    if (text.size() < sequence_header_size + field) {
        return std::nullopt;
    }
    const std::size_t end = text.size() - (is_large ? 1 : 0); // of the padding
    const std::byte filler = text[end - 1];
    std::size_t count = std::to_integer<std::size_t>(filler);
    count += is_large ? 256 * std::to_integer<std::size_t>(text.back()) : 0;
    if (sequence_header_size + field + count > text.size()) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i <= count; ++i) { // the size's own byte is like those behind it
        if (text[end - 1 - i] != filler) {
            return std::nullopt;
        }
    }
    return Bytes{text.begin(), text.end() - static_cast<std::ptrdiff_t>(field + count)};
}

/// A few bytes changed, counted from the end, where the padding is.
bool change(Bytes& text, fuzz::Script& script)
{
    const Bytes before = text;
    for (int i = script.byte() % 4; i != 0; --i) {
        const std::size_t at = script.byte() % text.size();
        text[text.size() - 1 - at] = static_cast<std::byte>(script.byte());
    }
    return text != before;
}

/// The text alone: what comes out is what Part 6 says of it, or nothing.
void open(const Keys& keys, fuzz::Script& script)
{
    const auto& policy = small_key_policy();
    const std::size_t more = script.byte() % 8;
    const std::uint8_t flip = script.byte();
    const auto content = script.bytes(script.byte());
    Bytes text(sequence_header_size);
    text.insert(text.end(), content.begin(), content.end());
    pad(text, policy, keys, more);
    change(text, script);
    Bytes message = sealed(policy, keys, text);
    const auto header = parse_asymmetric_header(message);
    require(header.has_value());
    auto used = *header;
    used.policy = &policy;
    const bool is_flipped = flip >= 0xe0;
    if (is_flipped) {
        const std::size_t at = script.byte() + std::size_t{script.byte()} * 256;
        message[at % message.size()] ^= static_cast<std::byte>(1U << flip % 8U);
    }
    const auto opened =
        open_asymmetric(message, used, &keys.receiver.key, &keys.sender.certificates.front());
    const bool is_small = (message.size() - header->size) / keys.receiver.key.key_size() <= 8;
    const auto expected = unpadded(text, keys.receiver.key.key_size() > 256);
    require(opened.has_value() == (expected && !is_flipped && is_small));
    require(opened || opened.error() == status::Bad_SecurityChecksFailed);
    if (opened) {
        const std::span<const std::byte> body = std::span{*expected}.subspan(sequence_header_size);
        require(std::ranges::equal(opened->body, body));
    }
}

/// A request that may be as it should be.
OpenSecureChannelRequest request_of(fuzz::Script& script, bool& is_right)
{
    OpenSecureChannelRequest request;
    const std::uint8_t shape = script.byte();
    request.request_type = static_cast<SecurityTokenRequestType>(shape & 1U);
    request.security_mode = static_cast<MessageSecurityMode>(3U - (shape >> 1U & 3U));
    request.requested_lifetime = script.byte() * 100'000U;
    const std::size_t nonce = shape < 0xe0 ? 32 : shape % 64;
    request.client_nonce = ByteString{Bytes(nonce, std::byte{1})};
    is_right = request.request_type == SecurityTokenRequestType::Issue && nonce == 32 &&
               (request.security_mode == MessageSecurityMode::SignAndEncrypt ||
                request.security_mode == MessageSecurityMode::Sign);
    return request;
}

struct Server {
    explicit Server(const Keys& keys)
        : engine{config(),
                 {.random = &random,
                  .wall_clock = &wall_clock,
                  .log = &log,
                  .validator = &validator,
                  .identity = &keys.receiver},
                 {}}
    {
        OutputBuffer out;
        write_hello(out, {0, 65'535, 65'535, 0, 0, String{"opc.tcp://localhost"}});
        static_cast<void>(engine.feed(out.output(), {}));
        require(!engine.next_event());
        engine.consume(engine.output().size());
    }

    [[nodiscard]] static channel::ServerChannelConfig config()
    {
        channel::ServerChannelConfig config;
        config.allowed = {{&usual_policy(), MessageSecurityMode::Sign},
                          {&usual_policy(), MessageSecurityMode::SignAndEncrypt}};
        config.channel_id = channel_id;
        return config;
    }

    test::SeededRandom random;
    test::FixedWallClock wall_clock;
    NullLog log;
    crypto::InsecureAcceptAnyCertificate validator;
    channel::ServerChannel engine;
};

/// The status of the Error message that a server's output begins with.
StatusCode told_by(const channel::ServerChannel& server)
{
    const auto out = server.output();
    require(out.size() > header_size && out[0] == std::byte{'E'});
    const auto error = parse_error(out.subspan(header_size));
    require(error.has_value());
    return error->error;
}

/// A server that gets it: what opens a channel is what is right in all, and of what is wrong behind
/// the encryption but for the request itself nobody is told more than that it is.
void serve(fuzz::Script& script)
{
    const Keys& keys = usual_keys();
    Server server{keys};
    bool is_right = false;
    const auto request = request_of(script, is_right);
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.number(std::uint32_t{script.byte()});
    writer.number(std::uint32_t{script.byte()});
    encode_message(writer, request);
    Bytes text = sink.take(writer.written());
    const std::uint8_t changes = script.byte();
    const bool is_body_changed = changes >= 0x80 && change(text, script);
    pad(text, usual_policy(), keys, 0);
    const bool is_padding_changed = (changes & 0x40U) != 0 && change(text, script);
    const bool is_padded = unpadded(text, false).has_value();
    const Bytes message = sealed(usual_policy(), keys, text);
    static_cast<void>(server.engine.feed(message, {}));
    const auto event = server.engine.next_event();
    require(event.has_value());
    if (!is_body_changed && !is_padding_changed) {
        require((event->kind == Kind::Opened) == is_right);
    }
    require(event->kind != Kind::Opened || is_padded);
    require(server.engine.is_open() == (event->kind == Kind::Opened));
    if (!server.engine.is_open()) {
        require(is_padded || told_by(server.engine) == status::Bad_SecurityChecksFailed);
    }
}

} // namespace

/// OpenSecureChannel as a peer with keys of its own can make it: any text, right in signature and
/// encryption. The first byte chooses keys, and whether a server gets it or the parser alone.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    const std::uint8_t how = script.byte() % 8;
    if (how < 5) {
        open(small_keys(), script);
    } else if (how == 5) {
        open(keys_of_large_padding(), script);
    } else {
        serve(script);
    }
    return 0;
}

} // namespace open_text_fuzz

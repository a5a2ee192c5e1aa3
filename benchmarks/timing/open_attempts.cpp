#include "experiment.hpp"

#include <cstdio>
#include <cstdlib>
#include <memory>

#include <busbar/binary/codec.hpp>
#include <busbar/channel/server_channel.hpp>
#include <busbar/types/secure_channel.hpp>

#include "attempts.hpp"

namespace busbar::timing {

namespace {

struct World {
    channel::ApplicationIdentity server = make_identity("server");
    channel::ApplicationIdentity client = make_identity("client");
    channel::ApplicationIdentity stranger = make_identity("stranger");
    crypto::SystemRandom random;
    FixedWallClock wall_clock;
    NullLog log;
};

const World& world()
{
    static const World instance;
    return instance;
}

/// Trusts the client alone, by all the steps of Part 4, 6.1.3.
class TrustsClient final : public crypto::CertificateValidator {
public:
    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext& context) override
    {
        if (auto refusal = crypto::check_chain(chain, list_, context)) {
            return refuse(*std::move(refusal));
        }
        return {};
    }

private:
    crypto::TrustList list_{{world().client.certificates.front()}, {}, {}, {}};
};

enum class Fault {
    None,
    RsaPadding,
    OtherPadding,
    ShortBlock,
    Signature,
    Padding,
    Nonce,
    Untrusted,
};

/// The padding before the signature, which makes the text fill whole blocks (Part 6, 6.7.2.5).
void append_padding(Bytes& text, std::size_t block, bool is_wrong)
{
    const std::size_t count = (block - (text.size() + 1 + key_size) % block) % block;
    text.insert(text.end(), count + 1, static_cast<std::byte>(count));
    if (is_wrong) {
        text.back() ^= std::byte{0x80};
    }
}

Bytes encrypted(const crypto::SecurityPolicy& policy, const Bytes& text, Fault fault)
{
    const crypto::Certificate& receiver = world().server.certificates.front();
    const std::size_t block = crypto::plain_block_size(policy, key_size);
    if (fault == Fault::OtherPadding) {
        Bytes cipher;
        for (std::size_t at = 0; at < text.size(); at += block) {
            const auto part = crypto::asymmetric_encrypt(with_other_padding(policy), receiver,
                                                         std::span{text}.subspan(at, 100));
            cipher.insert(cipher.end(), part->begin(), part->end());
        }
        return cipher;
    }
    const std::size_t size = fault == Fault::ShortBlock ? text.size() - 20 : text.size();
    Bytes cipher =
        crypto::asymmetric_encrypt(policy, receiver, std::span{text}.first(size)).value();
    if (fault == Fault::RsaPadding) {
        spoil_block(cipher, 0);
    }
    return cipher;
}

Bytes body_of(const crypto::SecurityPolicy& policy, Fault fault)
{
    OpenSecureChannelRequest request;
    request.security_mode = MessageSecurityMode::SignAndEncrypt;
    request.client_nonce =
        ByteString{random_bytes(policy.nonce_size - (fault == Fault::Nonce ? 1 : 0))};
    request.requested_lifetime = 60'000;
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.number(std::uint32_t{1}); // sequence number
    writer.number(std::uint32_t{1}); // request id
    encode(writer, NodeId{0, OpenSecureChannelRequest::binary_encoding_id});
    encode(writer, request);
    return sink.take(writer.written());
}

Bytes headers_of(const crypto::SecurityPolicy& policy, const channel::ApplicationIdentity& sender,
                 std::size_t rest)
{
    const auto certificate = sender.certificates.front().der();
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.bytes(std::as_bytes(std::span{"OPNF", 4}));
    writer.number(static_cast<std::uint32_t>(12 + 3 * 4 + policy.uri.size() + certificate.size() +
                                             20 + rest));
    writer.number(std::uint32_t{0}); // SecureChannelId
    encode(writer, String{policy.uri});
    encode(writer, ByteString{certificate});
    encode(writer, ByteString{world().server.certificates.front().thumbprint()});
    return sink.take(writer.written());
}

Bytes open_message(const crypto::SecurityPolicy& policy, Fault fault)
{
    const auto& sender = fault == Fault::Untrusted ? world().stranger : world().client;
    const std::size_t block = crypto::plain_block_size(policy, key_size);
    Bytes text = body_of(policy, fault);
    append_padding(text, block, fault == Fault::Padding);
    Bytes message = headers_of(policy, sender, (text.size() + key_size) / block * key_size);
    Bytes signed_bytes = message;
    signed_bytes.insert(signed_bytes.end(), text.begin(), text.end());
    Bytes signature = crypto::asymmetric_sign(policy, sender.key, signed_bytes).value();
    if (fault == Fault::Signature) {
        signature[100] ^= std::byte{1};
    }
    text.insert(text.end(), signature.begin(), signature.end());
    const Bytes cipher = encrypted(policy, text, fault);
    message.insert(message.end(), cipher.begin(), cipher.end());
    return message;
}

Bytes hello()
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.bytes(std::as_bytes(std::span{"HELF", 4}));
    for (const std::uint32_t number : {32U, 0U, 65'535U, 65'535U, 0U, 0U, 0U}) {
        writer.number(number);
    }
    return sink.take(writer.written());
}

/// A server that waits for an OPN.
struct Waiting {
    explicit Waiting(const crypto::SecurityPolicy& policy)
        : server{config(policy),
                 {.random = &random,
                  .wall_clock = &world().wall_clock,
                  .log = &log,
                  .validator = &validator,
                  .identity = &world().server},
                 {}}
    {
        feed(hello());
    }
    void feed(const Bytes& bytes)
    {
        static_cast<void>(server.feed(bytes, {}));
        while (server.next_event()) {
        }
    }
    [[nodiscard]] static channel::ServerChannelConfig config(const crypto::SecurityPolicy& policy)
    {
        channel::ServerChannelConfig config;
        config.allowed = {{&policy, MessageSecurityMode::SignAndEncrypt}};
        return config;
    }

    crypto::SystemRandom random;
    NullLog log;
    TrustsClient validator;
    channel::ServerChannel server;
};

Attempt prepare(const crypto::SecurityPolicy& policy, Fault fault)
{
    auto waiting = std::make_shared<Waiting>(policy);
    return [waiting, fault, message = open_message(policy, fault)] {
        waiting->feed(message);
        if (waiting->server.is_open() != (fault == Fault::None)) {
            std::fprintf(stderr, "busbar-timing: an attempt did not end as it should\n");
            std::abort();
        }
    };
}

} // namespace

std::vector<InputClass> open_attempts(const crypto::SecurityPolicy& policy)
{
    const auto input = [&policy](const char* name, Fault fault) {
        return InputClass{name, [&policy, fault] { return prepare(policy, fault); },
                          fault == Fault::None};
    };
    return {input("wrong RSA padding", Fault::RsaPadding),
            input("padding of another OAEP hash", Fault::OtherPadding),
            input("wrong length of a block's text", Fault::ShortBlock),
            input("wrong signature", Fault::Signature),
            input("signed, wrong padding", Fault::Padding),
            input("signed, wrong nonce", Fault::Nonce),
            input("good, certificate not trusted", Fault::Untrusted),
            input("good and accepted (control)", Fault::None)};
}

} // namespace busbar::timing

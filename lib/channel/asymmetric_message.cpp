#include "asymmetric_message.hpp"

#include <algorithm>

#include <busbar/binary/codec.hpp>
#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/secret.hpp>

#include "frame.hpp"
#include "refusals.hpp"

namespace busbar::channel::detail {

namespace {

constexpr std::size_t thumbprint_size = 20;
constexpr std::uint32_t max_header_field = 65'535;
/// Maximum work of the receiver's private key for one message, even of a stranger. A request needs
/// two or three blocks, with the longest signature and the shortest key five.
constexpr std::size_t max_open_blocks = 8;

/// With keys of more than 2048 bits the padding's size takes two bytes (Part 6, 6.7.2.5).
std::size_t padding_field_size(std::size_t key_size)
{
    return key_size > 256 ? 2 : 1;
}

/// Removes the padding; all its bytes have the low byte of its size.
bool remove_padding(std::vector<std::byte>& plain, std::size_t key_size)
{
    const std::size_t field = padding_field_size(key_size);
    if (plain.size() < sequence_header_size + field) {
        return false;
    }
    std::size_t count = std::to_integer<std::size_t>(plain.back());
    if (field == 2) {
        count = count * 256 + std::to_integer<std::size_t>(plain[plain.size() - 2]);
    }
    if (count > plain.size() - sequence_header_size - field) {
        return false;
    }
    const std::size_t kept = plain.size() - field - count;
    const std::byte filler = plain[kept];
    const bool is_right = std::all_of(plain.begin() + static_cast<std::ptrdiff_t>(kept),
                                      plain.end() - static_cast<std::ptrdiff_t>(field - 1),
                                      [&](std::byte b) { return b == filler; }) &&
                          std::to_integer<std::size_t>(filler) == count % 256;
    plain.resize(kept);
    return is_right;
}

/// Returns the text after the headers, without its signature and padding.
Result<std::vector<std::byte>> decrypt_and_verify(std::span<const std::byte> message,
                                                  const AsymmetricHeader& header,
                                                  const crypto::PrivateKey& receiver,
                                                  const crypto::Certificate& sender)
{
    const auto cipher = message.subspan(header.size);
    const std::size_t signature_size = sender.key_size();
    if (cipher.size() > max_open_blocks * receiver.key_size()) {
        return security_failure();
    }
    auto plain = crypto::asymmetric_decrypt(*header.policy, receiver, cipher);
    if (!plain || plain->size() < signature_size + sequence_header_size) {
        return security_failure(); // both depend only on the sizes of message and keys
    }
    // Decrypted or random, from here on it is the same work, and refused for its signature.
    const std::size_t signed_size = plain->size() - signature_size;
    crypto::Secret signed_bytes{header.size + signed_size};
    std::copy_n(message.begin(), header.size, signed_bytes.span().begin());
    std::copy_n(plain->begin(), signed_size, signed_bytes.span().subspan(header.size).begin());
    const bool is_signed =
        crypto::asymmetric_verify(*header.policy, sender, signed_bytes.span(),
                                  std::span<const std::byte>{*plain}.subspan(signed_size))
            .has_value();
    plain->resize(signed_size);
    if (!is_signed || !remove_padding(*plain, receiver.key_size())) {
        crypto::cleanse(*plain);
        return security_failure();
    }
    return *std::move(plain);
}

/// Returns the headers with a size of 0 in the message header.
std::vector<std::byte> make_headers(const AsymmetricParts& parts)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.number(std::uint64_t{0});
    writer.number(parts.channel_id);
    encode(writer, String::borrow(parts.policy->uri));
    if (parts.policy->is_none()) {
        encode(writer, ByteString{});
        encode(writer, ByteString{});
    } else {
        std::vector<std::byte> chain;
        for (const crypto::Certificate& certificate : parts.sender->certificates) {
            chain.insert(chain.end(), certificate.der().begin(), certificate.der().end());
        }
        encode(writer, ByteString::borrow(chain));
        encode(writer, ByteString{parts.receiver->thumbprint()});
    }
    return sink.take(writer.written());
}

void append_content(std::vector<std::byte>& message, const AsymmetricParts& parts)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.number(parts.sequence_number);
    writer.number(parts.request_id);
    writer.bytes(parts.body);
    const auto content = sink.take(writer.written());
    message.insert(message.end(), content.begin(), content.end());
}

/// Pads the part after the headers so that, with its signature, it fills whole blocks.
void append_padding(std::vector<std::byte>& message, std::size_t headers, std::size_t key_size,
                    std::size_t block, std::size_t signature_size)
{
    const std::size_t field = padding_field_size(key_size);
    const std::size_t used = message.size() - headers + field + signature_size;
    const std::size_t count = (block - used % block) % block;
    message.insert(message.end(), count + 1, static_cast<std::byte>(count));
    if (field == 2) {
        message.push_back(static_cast<std::byte>(count >> 8U));
    }
}

Result<void> secure(std::vector<std::byte>& message, std::size_t headers,
                    const AsymmetricParts& parts)
{
    const std::size_t key_size = parts.receiver->key_size();
    const std::size_t signature_size = parts.sender->key.key_size();
    const std::size_t block = crypto::plain_block_size(*parts.policy, key_size);
    if (block == 0) {
        return security_failure();
    }
    append_padding(message, headers, key_size, block, signature_size);
    const std::size_t blocks = (message.size() - headers + signature_size) / block;
    const std::size_t size = headers + blocks * key_size;
    write_frame_header(message, {MessageType::OPN, 'F', static_cast<std::uint32_t>(size)});
    const auto signature = crypto::asymmetric_sign(*parts.policy, parts.sender->key, message);
    if (!signature) {
        return security_failure();
    }
    message.insert(message.end(), signature->begin(), signature->end());
    const auto cipher = crypto::asymmetric_encrypt(*parts.policy, *parts.receiver,
                                                   std::span{message}.subspan(headers));
    if (!cipher) {
        return security_failure();
    }
    message.resize(headers);
    message.insert(message.end(), cipher->begin(), cipher->end());
    return {};
}

} // namespace

Result<AsymmetricHeader> parse_asymmetric_header(std::span<const std::byte> message)
{
    binary::DecodeLimits limits;
    limits.max_byte_string_length = max_header_field;
    limits.max_string_length = 255; // Part 6, 6.7.2.3
    binary::Reader reader{message, binary::Strings::Borrow, nullptr, limits};
    AsymmetricHeader header;
    String policy_uri;
    ByteString certificate;
    ByteString thumbprint;
    reader.skip(header_size);
    header.channel_id = reader.number<std::uint32_t>();
    decode(reader, policy_uri);
    decode(reader, certificate);
    decode(reader, thumbprint);
    if (!reader.ok() || (!thumbprint.empty() && thumbprint.size() != thumbprint_size)) {
        return fail(status::Bad_DecodingError);
    }
    header.policy = crypto::find_policy(policy_uri.view());
    if (header.policy == nullptr) {
        return fail(status::Bad_SecurityPolicyRejected);
    }
    header.sender_certificate = certificate.span();
    header.receiver_thumbprint = thumbprint.span();
    header.size = reader.offset();
    return header;
}

Result<AsymmetricContent> open_asymmetric(std::span<const std::byte> message,
                                          const AsymmetricHeader& header,
                                          const crypto::PrivateKey* receiver,
                                          const crypto::Certificate* sender)
{
    std::vector<std::byte> plain;
    if (header.policy->is_none()) {
        const auto rest = message.subspan(header.size);
        plain.assign(rest.begin(), rest.end());
    } else {
        auto decrypted = decrypt_and_verify(message, header, *receiver, *sender);
        if (!decrypted) {
            return security_failure();
        }
        plain = *std::move(decrypted);
    }
    binary::Reader reader{plain};
    AsymmetricContent content;
    content.sequence_number = reader.number<std::uint32_t>();
    content.request_id = reader.number<std::uint32_t>();
    if (!reader.ok()) {
        return security_failure();
    }
    content.body.assign(plain.begin() + sequence_header_size, plain.end());
    crypto::cleanse(plain); // it contains a nonce
    return content;
}

Result<std::vector<std::byte>> make_asymmetric(const AsymmetricParts& parts, std::size_t max_size)
{
    std::vector<std::byte> message = make_headers(parts);
    const std::size_t headers = message.size();
    append_content(message, parts);
    if (!parts.policy->is_none()) {
        const auto secured = secure(message, headers, parts);
        if (!secured) {
            return fail(secured.error());
        }
    }
    if (message.size() > max_size) {
        return fail(status::Bad_TcpMessageTooLarge);
    }
    write_frame_header(message,
                       {MessageType::OPN, 'F', static_cast<std::uint32_t>(message.size())});
    return message;
}

Result<void> seal_asymmetric(OutputBuffer& output, const AsymmetricParts& parts,
                             std::size_t max_size)
{
    const auto message = make_asymmetric(parts, max_size);
    if (!message) {
        return fail(message.error());
    }
    std::copy(message->begin(), message->end(), output.reserve(message->size()).begin());
    output.commit(message->size());
    return {};
}

} // namespace busbar::channel::detail

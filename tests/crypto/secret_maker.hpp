#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <busbar/crypto/encrypted_secret.hpp>
#include <busbar/crypto/symmetric.hpp>

/// RsaEncryptedSecrets put together from their fields, right or wrong (Part 4, tables 183 and 185).
namespace busbar::test {

/// The fields as numbers and bytes of UA Binary.
class SecretText {
public:
    SecretText& number(std::uint64_t value, unsigned size)
    {
        for (unsigned i = 0; i < size; ++i) {
            bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
        }
        return *this;
    }
    SecretText& raw(std::span<const std::byte> more)
    {
        bytes.insert(bytes.end(), more.begin(), more.end());
        return *this;
    }
    SecretText& byte_string(std::span<const std::byte> more)
    {
        return number(more.size(), 4).raw(more);
    }

    crypto::Bytes bytes;
};

struct SecretParts {
    crypto::Bytes signing_key;
    crypto::Bytes encrypting_key;
    crypto::Bytes initialization_vector;
    /// Nonce, secret, padding and its size, before encryption.
    crypto::Bytes payload;
    std::string_view uri;
    crypto::Bytes thumbprint;
    std::uint64_t type{17'545};
    std::uint8_t mask{1};
    /// The NodeId with four bytes of a number.
    bool is_long{false};
    /// Instead of what it is.
    std::optional<std::uint64_t> length{};
};

/// Keys of the sizes of the policy, which are no secret.
[[nodiscard]] inline SecretParts secret_parts(const crypto::SecurityPolicy& policy,
                                              const crypto::Certificate& certificate,
                                              crypto::Bytes payload)
{
    return {crypto::Bytes(policy.signing_key_size, std::byte{1}),
            crypto::Bytes(policy.encrypting_key_size, std::byte{2}),
            crypto::Bytes(policy.block_size, std::byte{3}),
            std::move(payload),
            policy.uri,
            certificate.thumbprint()};
}

/// The payload of a secret, with `padding` bytes of that value.
[[nodiscard]] inline crypto::Bytes secret_payload(std::span<const std::byte> nonce,
                                                  std::span<const std::byte> secret,
                                                  std::size_t padding)
{
    SecretText text;
    text.byte_string(nonce).byte_string(secret);
    text.raw(crypto::Bytes(padding, static_cast<std::byte>(padding))).number(padding, 2);
    return text.bytes;
}

/// Encrypted and signed with the keys in `parts`; nothing if they, or the size of the payload, are
/// none of the policy's.
[[nodiscard]] inline std::optional<crypto::Bytes>
make_secret(const crypto::SecurityPolicy& policy, const crypto::Certificate& certificate,
            const SecretParts& parts)
{
    SecretText keys;
    keys.byte_string(parts.signing_key).byte_string(parts.encrypting_key);
    keys.byte_string(parts.initialization_vector);
    const auto key_data = crypto::asymmetric_encrypt(policy, certificate, keys.bytes);
    const auto padded = [](const crypto::Bytes& key, std::size_t size) {
        crypto::Bytes copy = key; // so that there is a cipher for wrong ones, too
        copy.resize(size);
        return crypto::Secret{copy};
    };
    crypto::SymmetricKeys used;
    used.signing_key = padded(parts.signing_key, policy.signing_key_size);
    used.encrypting_key = padded(parts.encrypting_key, policy.encrypting_key_size);
    used.initialization_vector = padded(parts.initialization_vector, policy.block_size);
    auto cipher = crypto::SymmetricCipher::create(policy, used);
    crypto::Bytes payload = parts.payload;
    if (!key_data || !cipher || !cipher->encrypt(payload)) {
        return std::nullopt;
    }
    SecretText body;
    body.byte_string(std::as_bytes(std::span{parts.uri})).byte_string(parts.thumbprint);
    body.number(0x01DC'0000'0000'0000, 8).number(key_data->size(), 2);
    body.raw(*key_data).raw(payload);
    const std::size_t whole = body.bytes.size() + policy.symmetric_signature_size;
    SecretText text;
    if (parts.is_long) {
        text.number(2, 1).number(0, 2).number(parts.type, 4);
    } else {
        text.number(1, 1).number(0, 1).number(parts.type, 2);
    }
    text.number(parts.mask, 1);
    text.number(parts.length.value_or(whole), 4).raw(body.bytes);
    crypto::Bytes signature(policy.symmetric_signature_size);
    if (!cipher->sign(text.bytes, signature)) {
        return std::nullopt;
    }
    return text.raw(signature).bytes;
}

} // namespace busbar::test

#pragma once

#include <string>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/self_signed.hpp>

namespace busbar::timing {

using Bytes = std::vector<std::byte>;

/// The size of all keys here, and so of a cipher block, in bytes.
inline constexpr std::size_t key_size = 256;

[[nodiscard]] inline Bytes random_bytes(std::size_t size)
{
    Bytes bytes(size);
    crypto::SystemRandom random;
    static_cast<void>(random.fill(bytes));
    return bytes;
}

/// Replaces the block of `cipher` that begins at `at` by chance, below the modulus: no padding
/// fits.
inline void spoil_block(Bytes& cipher, std::size_t at)
{
    const Bytes chance = random_bytes(key_size);
    std::copy(chance.begin(), chance.end(), cipher.begin() + static_cast<std::ptrdiff_t>(at));
    cipher[at] = std::byte{0};
}

/// The policy with another padding for encryption, and nothing else of it changed.
[[nodiscard]] inline crypto::SecurityPolicy with_other_padding(crypto::SecurityPolicy policy)
{
    policy.encryption = policy.encryption == crypto::AsymmetricEncryption::OaepSha256
                            ? crypto::AsymmetricEncryption::OaepSha1
                            : crypto::AsymmetricEncryption::OaepSha256;
    return policy;
}

/// The moment at which everything here takes place.
inline constexpr DateTime now = DateTime::from_unix_seconds(1'767'225'600);

class FixedWallClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override { return timing::now; }
};

/// A new application with a self-signed certificate of a 2048-bit key, which all policies allow.
[[nodiscard]] inline channel::ApplicationIdentity make_identity(const std::string& name)
{
    auto key = crypto::PrivateKey::generate(2'048).value();
    crypto::CertificateSubject subject;
    subject.common_name = name;
    subject.application_uri = "urn:busbar:timing:" + name;
    subject.dns_names = {"localhost"};
    subject.valid_from = now;
    return {{crypto::create_self_signed(key, subject).value()}, key};
}

} // namespace busbar::timing

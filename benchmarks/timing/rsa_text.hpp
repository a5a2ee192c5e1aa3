#pragma once

#include <vector>

#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/random.hpp>

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

} // namespace busbar::timing

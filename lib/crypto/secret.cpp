#include <busbar/crypto/secret.hpp>

#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <climits>

#include <busbar/crypto/random.hpp>

#include "openssl.hpp"

namespace busbar::crypto {

void cleanse(std::span<std::byte> bytes)
{
    if (!bytes.empty()) {
        OPENSSL_cleanse(bytes.data(), bytes.size());
    }
}

bool equal_in_constant_time(std::span<const std::byte> a, std::span<const std::byte> b)
{
    return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

Result<void> SystemRandom::fill(std::span<std::byte> bytes)
{
    if (bytes.size() > static_cast<std::size_t>(INT_MAX) ||
        RAND_bytes(detail::bytes_of(bytes), static_cast<int>(bytes.size())) != 1) {
        return fail(status::Bad_ResourceUnavailable);
    }
    return {};
}

void add_entropy(std::span<const std::byte> bytes)
{
    constexpr double estimate = 0.0;
    RAND_add(bytes.data(), static_cast<int>(std::min(bytes.size(), std::size_t{INT_MAX})),
             estimate);
}

} // namespace busbar::crypto

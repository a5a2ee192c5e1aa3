#include <busbar/crypto/digest.hpp>

#include "openssl.hpp"

namespace busbar::crypto {

std::array<std::byte, 32> sha256(std::span<const std::byte> bytes)
{
    std::array<std::byte, 32> digest{};
    EVP_Digest(bytes.data(), bytes.size(), detail::bytes_of(std::span<std::byte>{digest}), nullptr,
               EVP_sha256(), nullptr);
    return digest;
}

} // namespace busbar::crypto

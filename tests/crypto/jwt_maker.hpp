#pragma once

#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>

#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/jwt.hpp>
#include <busbar/crypto/private_key.hpp>

#include "core/base64.hpp"

/// JSON Web Tokens of every kind, right and wrong.
namespace busbar::test {

[[nodiscard]] inline std::string base64url(std::span<const std::byte> bytes)
{
    std::string text = busbar::detail::to_base64(bytes);
    std::replace(text.begin(), text.end(), '+', '-');
    std::replace(text.begin(), text.end(), '/', '_');
    return text.substr(0, text.find('='));
}
[[nodiscard]] inline std::string base64url(std::string_view text)
{
    return base64url(std::as_bytes(std::span{text}));
}

/// Signs as the policy does: Basic256Sha256 as RS256, Aes256_Sha256_RsaPss as PS256.
[[nodiscard]] inline std::string rsa_token(std::string_view header, std::string_view claims,
                                           const crypto::PrivateKey& key,
                                           std::string_view policy = "Basic256Sha256")
{
    const std::string text = base64url(header) + "." + base64url(claims);
    const auto signature = crypto::asymmetric_sign(*crypto::find_policy_by_name(policy), key,
                                                   std::as_bytes(std::span{text}));
    return text + "." + base64url(*signature);
}

[[nodiscard]] inline std::string hmac_token(std::string_view header, std::string_view claims,
                                            std::string_view secret)
{
    const std::string text = base64url(header) + "." + base64url(claims);
    unsigned char mac[EVP_MAX_MD_SIZE];
    unsigned size = 0;
    HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
         reinterpret_cast<const unsigned char*>(text.data()), text.size(), mac, &size);
    return text + "." + base64url(std::as_bytes(std::span{mac, size}));
}

} // namespace busbar::test

#pragma once

#include <span>
#include <string_view>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/crypto/asymmetric.hpp>
#include <busbar/types/session.hpp>

#include "support/identity.hpp"

/// What a client proves itself with to the server of server_identity().
namespace busbar::test {

/// Over the server's certificate and last nonce (Part 4, 5.7.3.1); empty with policy None.
[[nodiscard]] inline SignatureData sign_session(const crypto::SecurityPolicy& policy,
                                                const channel::ApplicationIdentity& identity,
                                                const ByteString& server_nonce)
{
    SignatureData data;
    if (policy.is_none()) {
        return data;
    }
    const auto der = server_identity().certificates.front().der();
    std::vector<std::byte> text{der.begin(), der.end()};
    text.insert(text.end(), server_nonce.span().begin(), server_nonce.span().end());
    data.algorithm = policy.signature_uri;
    data.signature = ByteString{crypto::asymmetric_sign(policy, identity.key, text).value()};
    return data;
}

/// A user name token, its password encrypted unless the policy is None.
[[nodiscard]] inline ExtensionObject user_token(const crypto::SecurityPolicy& policy,
                                                std::string_view name, std::string_view password,
                                                const ByteString& server_nonce)
{
    UserNameIdentityToken token;
    token.policy_id = String{"username_" + std::string{policy.name}};
    token.user_name = name;
    const auto secret = std::as_bytes(std::span{password});
    if (policy.is_none()) {
        token.password = ByteString{secret};
        return ExtensionObject::from(token);
    }
    token.encryption_algorithm = policy.encryption_uri;
    token.password =
        ByteString{crypto::encrypt_secret(policy, server_identity().certificates.front(), secret,
                                          server_nonce.span())
                       .value()};
    return ExtensionObject::from(token);
}

} // namespace busbar::test

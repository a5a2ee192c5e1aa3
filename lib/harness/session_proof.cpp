#include "session_proof.hpp"

#include <vector>

#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/security_policy.hpp>

namespace busbar::harness::detail {

ByteString new_nonce(crypto::Random& random)
{
    std::vector<std::byte> nonce(32);
    static_cast<void>(random.fill(nonce));
    return ByteString{nonce};
}

Result<SignatureData> sign_nonce(const channel::SecuritySetting& security,
                                 const channel::ApplicationIdentity* identity,
                                 std::span<const std::byte> certificate,
                                 std::span<const std::byte> nonce)
{
    SignatureData signature;
    if (security.policy->is_none() || identity == nullptr) {
        return signature;
    }
    std::vector<std::byte> text{certificate.begin(), certificate.end()};
    text.insert(text.end(), nonce.begin(), nonce.end());
    const auto bytes = crypto::asymmetric_sign(*security.policy, identity->key, text);
    if (!bytes) {
        return fail(bytes.error());
    }
    signature.algorithm = security.policy->signature_uri;
    signature.signature = ByteString{*bytes};
    return signature;
}

String anonymous_policy(const Array<EndpointDescription>& endpoints,
                        const channel::SecuritySetting& security)
{
    for (const EndpointDescription& endpoint : endpoints) {
        if (endpoint.security_mode != security.mode ||
            endpoint.security_policy_uri.view() != security.policy->uri) {
            continue;
        }
        for (const UserTokenPolicy& policy : endpoint.user_identity_tokens) {
            if (policy.token_type == UserTokenType::Anonymous) {
                return policy.policy_id;
            }
        }
    }
    return {};
}

} // namespace busbar::harness::detail

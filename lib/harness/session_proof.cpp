#include "session_proof.hpp"

#include <vector>

#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/security_policy.hpp>

namespace busbar::harness::detail {

namespace {

std::vector<std::byte> signed_text(std::span<const std::byte> certificate,
                                   std::span<const std::byte> nonce)
{
    std::vector<std::byte> text{certificate.begin(), certificate.end()};
    text.insert(text.end(), nonce.begin(), nonce.end());
    return text;
}

} // namespace

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
    const auto bytes =
        crypto::asymmetric_sign(*security.policy, identity->key, signed_text(certificate, nonce));
    if (!bytes) {
        return fail(bytes.error());
    }
    signature.algorithm = security.policy->signature_uri;
    signature.signature = ByteString{*bytes};
    return signature;
}

bool is_signed_nonce(const crypto::SecurityPolicy& policy, const crypto::Certificate& signer,
                     const channel::ApplicationIdentity& own, std::span<const std::byte> chain,
                     std::span<const std::byte> nonce, const SignatureData& signature)
{
    const auto fits = [&](std::span<const std::byte> certificate) {
        return crypto::asymmetric_verify(policy, signer, signed_text(certificate, nonce),
                                         signature.signature.span())
            .has_value();
    };
    return fits(chain) || fits(own.certificates.front().der());
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

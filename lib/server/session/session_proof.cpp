#include "session_proof.hpp"

#include <busbar/crypto/asymmetric.hpp>

#include "server/engine/core.hpp"

namespace busbar::server::detail {

namespace {

std::vector<std::byte> join(std::span<const std::byte> a, std::span<const std::byte> b)
{
    std::vector<std::byte> all{a.begin(), a.end()};
    all.insert(all.end(), b.begin(), b.end());
    return all;
}

std::vector<std::byte> chain_of(const channel::ApplicationIdentity& identity)
{
    std::vector<std::byte> all;
    for (const crypto::Certificate& certificate : identity.certificates) {
        all.insert(all.end(), certificate.der().begin(), certificate.der().end());
    }
    return all;
}

} // namespace

Result<ByteString> random_bytes(const Core& core, std::size_t size)
{
    std::vector<std::byte> bytes(size);
    if (const auto filled = core.environment.random->fill(bytes); !filled) {
        return fail(filled.error());
    }
    return ByteString{bytes};
}

Result<SignatureData> sign_for_client(const Core& core, const channel::SecuritySetting& security,
                                      std::span<const std::byte> client_certificate,
                                      std::span<const std::byte> client_nonce)
{
    SignatureData signature;
    if (security.policy->is_none()) {
        return signature;
    }
    const auto bytes = crypto::asymmetric_sign(*security.policy, core.config.identity->key,
                                               join(client_certificate, client_nonce));
    if (!bytes) {
        return fail(bytes.error());
    }
    signature.algorithm = security.policy->signature_uri;
    signature.signature = ByteString{*bytes};
    return signature;
}

bool is_signed(const channel::ApplicationIdentity& server, const crypto::SecurityPolicy& policy,
               const crypto::Certificate& signer, std::span<const std::byte> server_nonce,
               const SignatureData& signature)
{
    if (policy.is_none() || signature.algorithm.view() != policy.signature_uri) {
        return false;
    }
    const auto fits = [&](std::span<const std::byte> certificate) {
        return crypto::asymmetric_verify(policy, signer, join(certificate, server_nonce),
                                         signature.signature.span())
            .has_value();
    };
    const auto& own = server.certificates;
    // The leaf; older clients sign the whole chain.
    return fits(own.front().der()) || (own.size() > 1 && fits(chain_of(server)));
}

bool is_signed_by_client(const Core& core, const channel::SecuritySetting& security,
                         const crypto::CertificateChain& client,
                         std::span<const std::byte> server_nonce, const SignatureData& signature)
{
    return security.policy->is_none() ||
           (!client.empty() && is_signed(*core.config.identity, *security.policy, client.front(),
                                         server_nonce, signature));
}

} // namespace busbar::server::detail

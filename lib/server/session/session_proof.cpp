#include "session_proof.hpp"

#include <busbar/crypto/asymmetric.hpp>

#include "server/users/token_checks.hpp"

namespace busbar::server::detail {

Result<ByteString> random_bytes(crypto::Random& random, std::size_t size)
{
    std::vector<std::byte> bytes(size);
    if (const auto filled = random.fill(bytes); !filled) {
        return fail(filled.error());
    }
    return ByteString{bytes};
}

Result<SignatureData> sign_for_client(const channel::ApplicationIdentity* server,
                                      const channel::SecuritySetting& security,
                                      std::span<const std::byte> client_certificate,
                                      std::span<const std::byte> client_nonce)
{
    SignatureData signature;
    if (security.policy->is_none()) {
        return signature;
    }
    const auto bytes = crypto::asymmetric_sign(*security.policy, server->key,
                                               join(client_certificate, client_nonce));
    if (!bytes) {
        return fail(bytes.error());
    }
    signature.algorithm = security.policy->signature_uri;
    signature.signature = ByteString{*bytes};
    return signature;
}

bool is_signed_by_client(const channel::ApplicationIdentity* server,
                         const channel::SecuritySetting& security,
                         const crypto::CertificateChain& client,
                         std::span<const std::byte> server_nonce, const SignatureData& signature)
{
    return security.policy->is_none() ||
           (!client.empty() &&
            is_signed(*server, *security.policy, client.front(), server_nonce, signature));
}

} // namespace busbar::server::detail

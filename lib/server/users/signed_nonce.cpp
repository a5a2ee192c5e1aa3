#include "token_checks.hpp"

#include <vector>

#include <busbar/crypto/asymmetric.hpp>

namespace busbar::server::detail {

namespace {

std::vector<std::byte> chain_of(const channel::ApplicationIdentity& identity)
{
    std::vector<std::byte> all;
    for (const crypto::Certificate& certificate : identity.certificates) {
        all.insert(all.end(), certificate.der().begin(), certificate.der().end());
    }
    return all;
}

} // namespace

std::vector<std::byte> join(std::span<const std::byte> a, std::span<const std::byte> b)
{
    std::vector<std::byte> all{a.begin(), a.end()};
    all.insert(all.end(), b.begin(), b.end());
    return all;
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

} // namespace busbar::server::detail

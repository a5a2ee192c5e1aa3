#pragma once

#include <algorithm>

#include <busbar/core/refusal.hpp>

#include "session_use.hpp"
#include "support/server_fixture.hpp"

// Behind the others, who have parameters with the name of its `now`.
#include "crypto/issuing.hpp"
#include "crypto/jwt_maker.hpp"

namespace busbar::test {

/// Trusts by a list (Part 4, 6.1.3).
class ListValidator final : public crypto::CertificateValidator {
public:
    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext& context) override
    {
        auto refusal = crypto::check_chain(chain, list, context);
        return refusal ? Checked<void>{refuse(*std::move(refusal))} : Checked<void>{};
    }

    crypto::TrustList list;
};

/// A certificate of a person, self-signed.
[[nodiscard]] inline const Issued& user_certificate()
{
    static const Issued issued = [] {
        CertificateOptions options;
        options.common_name = "maria";
        options.names = "";
        options.key_usage = "critical,digitalSignature";
        options.extended_key_usage = "clientAuth";
        return issue(options, key_number(3));
    }();
    return issued;
}

inline constexpr std::string_view token_secret = "0123456789abcdef0123456789abcdef";

/// A server for users of all kinds: the certificate above is trusted, tokens are signed with
/// token_secret.
class UserFixture : public ServerFixture {
public:
    explicit UserFixture(server::ServerConfig config = all_kinds())
        : ServerFixture{std::move(config)}
    {
        validator.list.trusted = {user_certificate().certificate};
        users.validator = &validator;
        users.rules.emplace();
        users.rules->issuer = "https://issuer";
        users.rules->keys = {
            crypto::JwtKey::from_shared_secret(std::as_bytes(std::span{token_secret})).value()};
    }

    /// Every endpoint for every kind, but anonymous only without security.
    [[nodiscard]] static server::ServerConfig all_kinds()
    {
        auto config = insecure_config();
        config.issuer.authority_url = "https://issuer";
        for (auto& endpoint : config.endpoints) {
            endpoint.allows_certificate = true;
            endpoint.allows_issued = true;
        }
        return config;
    }
    /// What ActivateSession answers, at once.
    [[nodiscard]] static StatusCode activate(TestClient& client, ExtensionObject token,
                                             SignatureData signature = {})
    {
        ActivateSessionRequest request;
        request.client_signature = client.signature();
        request.user_identity_token = std::move(token);
        request.user_token_signature = std::move(signature);
        const auto response = client.call<ActivateSessionResponse>(std::move(request));
        if (response) {
            client.server_nonce = response->server_nonce;
        }
        return response ? StatusCode{} : response.error();
    }
    /// Lines of the log that explain a refusal.
    [[nodiscard]] std::size_t refusals() const
    {
        std::size_t count = 0;
        std::size_t at = 0;
        while ((at = log.text.find(" failed: ", at)) != std::string::npos) {
            ++count;
            ++at;
        }
        return count;
    }

    ListValidator validator;
};

[[nodiscard]] inline ExtensionObject
certificate_token(std::span<const std::byte> der = user_certificate().certificate.der(),
                  std::string_view policy = "certificate_Basic256Sha256")
{
    X509IdentityToken token;
    token.policy_id = policy;
    token.certificate_data = ByteString{der};
    return ExtensionObject::from(token);
}

/// Over the server's certificate and the client's last nonce.
[[nodiscard]] inline SignatureData
user_signature(const TestClient& client, const crypto::PrivateKey& key = user_certificate().key)
{
    const auto& policy = *crypto::find_policy_by_name("Basic256Sha256");
    const auto der = server_identity().certificates.front().der();
    std::vector<std::byte> text{der.begin(), der.end()};
    text.insert(text.end(), client.server_nonce.span().begin(), client.server_nonce.span().end());
    SignatureData data;
    data.algorithm = policy.signature_uri;
    data.signature = ByteString{crypto::asymmetric_sign(policy, key, text).value()};
    return data;
}

/// Valid from `today` on.
[[nodiscard]] inline std::string jwt(const std::string& more = {}, int seconds = 3'600)
{
    return hmac_token(R"({"alg":"HS256"})",
                      R"({"sub":"maria","iss":"https://issuer","aud":"urn:busbar:test:server",)"
                      R"("exp":)" +
                          std::to_string(today.unix_seconds() + seconds) + more + "}",
                      token_secret);
}

[[nodiscard]] inline ExtensionObject issued_token(const TestClient& client, std::string_view jwt)
{
    const auto& policy = *crypto::find_policy_by_name("Basic256Sha256");
    IssuedIdentityToken token;
    token.policy_id = "issued_Basic256Sha256";
    token.encryption_algorithm = policy.encryption_uri;
    token.token_data = ByteString{
        crypto::encrypt_secret(policy, server_identity().certificates.front(),
                               std::as_bytes(std::span{jwt}), client.server_nonce.span(), 8'192)
            .value()};
    return ExtensionObject::from(token);
}

} // namespace busbar::test

#include "proxy_secrets.hpp"

#include <utility>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/encrypted_secret.hpp>

namespace busbar::harness::detail {

namespace {

constexpr std::size_t max_proxy_secret_size = 8'192;

} // namespace

Result<void> refuse_message(LogSink& log, StatusCode status, std::string_view check,
                            std::string found, std::string_view rule, std::string remedy)
{
    explain(log, "proxy", {status, check, std::move(found), rule, std::move(remedy)});
    return fail(status);
}

Result<std::optional<ProxySecret>> ProxySecrets::take(const channel::SecuritySetting& security,
                                                      const ByteString& nonce,
                                                      ExtensionObject& token) const
{
    const auto refused = [&](StatusCode status, std::string found, std::string_view rule,
                             std::string remedy) {
        return fail(
            refuse_message(*log_, status, "user token", std::move(found), rule, std::move(remedy))
                .error());
    };
    std::optional<ProxySecret> taken;
    if (token.get_if<X509IdentityToken>() != nullptr) {
        return refused(status::Bad_IdentityTokenRejected,
                       "a user certificate, whose owner has signed for the proxy, and cannot sign "
                       "for the server",
                       "Part 4, 7.40.5", "Log in by name, or connect without the proxy");
    }
    if (const auto* const user = token.get_if<UserNameIdentityToken>()) {
        UserNameIdentityToken changed = *user;
        auto secret = open(security, nonce, changed.policy_id, changed.password,
                           changed.encryption_algorithm);
        if (!secret) {
            return fail(secret.error());
        }
        taken = *std::move(secret);
        changed.password = {};
        changed.encryption_algorithm = {};
        token = ExtensionObject::from(std::move(changed));
    } else if (const auto* const issued = token.get_if<IssuedIdentityToken>()) {
        IssuedIdentityToken changed = *issued;
        auto secret = open(security, nonce, changed.policy_id, changed.token_data,
                           changed.encryption_algorithm);
        if (!secret) {
            return fail(secret.error());
        }
        taken = *std::move(secret);
        changed.token_data = {};
        changed.encryption_algorithm = {};
        token = ExtensionObject::from(std::move(changed));
    } else if (!token.is_null() && token.get_if<AnonymousIdentityToken>() == nullptr) {
        return refused(status::Bad_IdentityTokenInvalid,
                       "its type is unknown, or it cannot be decoded: it may have a secret",
                       "Part 4, 7.40.1", "Log in by name or as anonymous");
    }
    return taken;
}

Result<ProxySecret> ProxySecrets::open(const channel::SecuritySetting& security,
                                       const ByteString& nonce, const String& policy_id,
                                       const ByteString& data, const String& algorithm) const
{
    ProxySecret secret;
    const auto refused = [&](std::string found) {
        const auto result = refuse_message(
            *log_, status::Bad_IdentityTokenInvalid, "user token", std::move(found),
            "Part 4, 7.40.2", "The client has to read the endpoints through the proxy");
        return fail(result.error());
    };
    if (data.size() > max_proxy_secret_size) {
        return refused("its secret has more than 8192 bytes");
    }
    const bool is_sealed = crypto::is_encrypted_secret(data.span());
    if (algorithm.empty() && !is_sealed) {
        secret.text = crypto::Secret{data.span()};
        return secret;
    }
    secret.policy = endpoints_->token_policy(security, policy_id);
    if (secret.policy == nullptr || endpoints_->identity() == nullptr) {
        return refused("its secret is encrypted, and its policy names no way that is known");
    }
    secret.form = is_sealed ? ProxySecret::Form::Sealed : ProxySecret::Form::Legacy;
    const channel::ApplicationIdentity& own = *endpoints_->identity();
    auto text = is_sealed ? crypto::unseal_secret(*secret.policy, own.certificates.front(), own.key,
                                                  data.span(), nonce.span(), max_proxy_secret_size)
                          : crypto::decrypt_secret(*secret.policy, own.key, data.span(),
                                                   nonce.span(), max_proxy_secret_size);
    if (!text) {
        return refused("its secret is not encrypted for the proxy and the session's last nonce");
    }
    secret.text = *std::move(text);
    return secret;
}

Result<void> ProxySecrets::put(const ProxySecret& secret, const crypto::Certificate* server,
                               const ByteString& nonce, ExtensionObject& token) const
{
    ByteString data{secret.text.span()};
    String algorithm;
    if (secret.form != ProxySecret::Form::Plain) {
        if (server == nullptr) {
            return refuse_message(*log_, status::Bad_IdentityTokenRejected, "user token",
                                  "the server shows no certificate to encrypt its secret for",
                                  "Part 4, 7.40.2", "");
        }
        const bool is_sealed = secret.form == ProxySecret::Form::Sealed;
        auto encrypted = is_sealed
                             ? crypto::seal_secret(*secret.policy, *server, secret.text.span(),
                                                   nonce.span(), clock_->now())
                             : crypto::encrypt_secret(*secret.policy, *server, secret.text.span(),
                                                      nonce.span(), max_proxy_secret_size);
        if (!encrypted) {
            return fail(encrypted.error());
        }
        data = ByteString{*encrypted};
        algorithm = is_sealed ? String{} : String{secret.policy->encryption_uri};
    }
    if (const auto* const user = token.get_if<UserNameIdentityToken>()) {
        UserNameIdentityToken changed = *user;
        changed.password = std::move(data);
        changed.encryption_algorithm = std::move(algorithm);
        token = ExtensionObject::from(std::move(changed));
    } else if (const auto* const issued = token.get_if<IssuedIdentityToken>()) {
        IssuedIdentityToken changed = *issued;
        changed.token_data = std::move(data);
        changed.encryption_algorithm = std::move(algorithm);
        token = ExtensionObject::from(std::move(changed));
    }
    return {};
}

} // namespace busbar::harness::detail

#include "user_token.hpp"

#include <busbar/channel/server_certificate.hpp>
#include <busbar/core/text.hpp>
#include <busbar/crypto/encrypted_secret.hpp>
#include <busbar/types/session.hpp>

namespace busbar::client::detail {

namespace {

/// In bytes; a longer password than the legacy format has room for uses the other one (Part 4,
/// 7.40.4), which not every server knows.
constexpr std::size_t max_password_size = 256;
/// Issued tokens may be larger than passwords, in the legacy format, too.
constexpr std::size_t max_issued_size = 8'192;

bool is_for(const UserTokenPolicy& policy, const UserIdentity& identity)
{
    if (policy.token_type != type_of(identity)) {
        return false;
    }
    const auto* issued = std::get_if<IssuedUser>(&identity);
    return issued == nullptr || policy.issued_token_type.view() == issued->type_uri;
}

/// Returns whether the secrets of `identity` are safe with `security` over the channel.
bool is_safe(const crypto::SecurityPolicy& security, const channel::SecuritySetting& channel,
             const UserIdentity& identity)
{
    switch (type_of(identity)) {
    case UserTokenType::Anonymous:
        return true;
    case UserTokenType::Certificate:
        return !security.is_none();
    case UserTokenType::UserName:
    case UserTokenType::IssuedToken:
        break;
    }
    return !security.is_none() || channel.mode == MessageSecurityMode::SignAndEncrypt;
}

/// The parts of a token except the identity.
struct TokenContext {
    const ConnectionConfig& config;
    const channel::ChannelEnvironment& environment;
    const UserTokenPolicy& policy;
    const crypto::SecurityPolicy& security;
    const ByteString& server_nonce;
};

Result<void> refuse(const TokenContext& context, StatusCode status, std::string found)
{
    explain(*context.environment.log, "client",
            {status, "user token", std::move(found), "Part 4, 7.40",
             "Let the server offer another user token policy, or another endpoint"});
    return fail(status);
}

/// Without security in the channel the certificate has not been checked yet (Part 4, 6.1.3): a
/// secret encrypted for any key is not secret.
Result<void> check_server(const TokenContext& context)
{
    const auto& channel = context.config.channel;
    if (!channel.server_certificate) {
        return refuse(context, status::Bad_CertificateInvalid,
                      "the server shows no certificate to encrypt it for");
    }
    if (!channel.security.policy->is_none()) {
        return {}; // the channel did
    }
    if (context.environment.validator == nullptr) {
        return refuse(context, status::Bad_ConfigurationError,
                      "there is no validator for the server's certificate");
    }
    const auto valid = channel::validate_server(context.environment, {*channel.server_certificate},
                                                context.security, channel.expected_server_uri,
                                                channel.endpoint_url);
    if (!valid) {
        explain(*context.environment.log, "client", valid.error());
        return fail(valid.error().status);
    }
    return {};
}

struct ProtectedSecret {
    ByteString data;
    String algorithm;
};

/// Part 4, 7.40.2; unencrypted only if the channel encrypts it.
Result<ProtectedSecret> protect(const TokenContext& context, std::string_view secret,
                                std::size_t max_legacy_size, std::size_t max_size)
{
    const auto bytes = std::as_bytes(std::span{secret});
    if (context.security.is_none()) {
        return ProtectedSecret{ByteString{bytes}, {}};
    }
    if (auto checked = check_server(context); !checked) {
        return fail(checked.error());
    }
    if (secret.size() > max_size) {
        return fail(refuse(context, status::Bad_IdentityTokenInvalid,
                           "it has more than " + std::to_string(max_size) + " bytes")
                        .error());
    }
    const crypto::Certificate& server = *context.config.channel.server_certificate;
    const bool is_legacy = secret.size() <= max_legacy_size;
    const auto encrypted =
        is_legacy
            ? crypto::encrypt_secret(context.security, server, bytes, context.server_nonce.span(),
                                     max_legacy_size)
            : crypto::seal_secret(context.security, server, bytes, context.server_nonce.span(),
                                  context.environment.wall_clock->now());
    if (!encrypted) {
        return fail(
            refuse(context, encrypted.error(),
                   "it cannot be encrypted: the server's nonce is too short, or its key unfit")
                .error());
    }
    return ProtectedSecret{ByteString{*encrypted},
                           is_legacy ? String{context.security.encryption_uri} : String{}};
}

Result<UserToken> make(const TokenContext& context, const AnonymousUser&)
{
    AnonymousIdentityToken token;
    token.policy_id = context.policy.policy_id;
    return UserToken{ExtensionObject::from(std::move(token)), {}};
}

Result<UserToken> make(const TokenContext& context, const NamedUser& user)
{
    auto secret = protect(context, user.password, crypto::max_secret_size, max_password_size);
    if (!secret) {
        return fail(secret.error());
    }
    UserNameIdentityToken token;
    token.policy_id = context.policy.policy_id;
    token.user_name = String{user.user_name};
    token.password = std::move(secret->data);
    token.encryption_algorithm = std::move(secret->algorithm);
    return UserToken{ExtensionObject::from(std::move(token)), {}};
}

Result<UserToken> make(const TokenContext& context, const CertificateUser& user)
{
    if (user.key == nullptr) {
        return fail(status::Bad_ConfigurationError);
    }
    if (auto checked = check_server(context); !checked) {
        return fail(checked.error());
    }
    if (context.server_nonce.size() < crypto::min_server_nonce_size) {
        return fail(status::Bad_NonceInvalid);
    }
    auto signature = sign(context.security, *user.key, *context.config.channel.server_certificate,
                          context.server_nonce);
    if (!signature) {
        return fail(signature.error());
    }
    X509IdentityToken token;
    token.policy_id = context.policy.policy_id;
    token.certificate_data = ByteString{user.certificate.der()};
    return UserToken{ExtensionObject::from(std::move(token)), *std::move(signature)};
}

Result<UserToken> make(const TokenContext& context, const IssuedUser& user)
{
    auto secret = protect(context, user.token, max_issued_size, max_issued_size);
    if (!secret) {
        return fail(secret.error());
    }
    IssuedIdentityToken token;
    token.policy_id = context.policy.policy_id;
    token.token_data = std::move(secret->data);
    token.encryption_algorithm = std::move(secret->algorithm);
    return UserToken{ExtensionObject::from(std::move(token)), {}};
}

} // namespace

UserTokenType type_of(const UserIdentity& identity)
{
    switch (identity.index()) {
    case 1:
        return UserTokenType::UserName;
    case 2:
        return UserTokenType::Certificate;
    case 3:
        return UserTokenType::IssuedToken;
    default:
        return UserTokenType::Anonymous;
    }
}

std::vector<std::byte> join(std::span<const std::byte> a, std::span<const std::byte> b)
{
    std::vector<std::byte> joined{a.begin(), a.end()};
    joined.insert(joined.end(), b.begin(), b.end());
    return joined;
}

Result<SignatureData> sign(const crypto::SecurityPolicy& policy, const crypto::PrivateKey& key,
                           const crypto::Certificate& server, const ByteString& server_nonce)
{
    const auto signature =
        crypto::asymmetric_sign(policy, key, join(server.der(), server_nonce.span()));
    if (!signature) {
        return fail(signature.error());
    }
    SignatureData data;
    data.algorithm = String{policy.signature_uri};
    data.signature = ByteString{*signature};
    return data;
}

const crypto::SecurityPolicy* token_security(const UserTokenPolicy& policy,
                                             const crypto::SecurityPolicy& channel,
                                             const UserIdentity& identity)
{
    const bool is_of_channel =
        policy.security_policy_uri.empty() || type_of(identity) == UserTokenType::Anonymous;
    const auto* used =
        is_of_channel ? &channel : crypto::find_policy(policy.security_policy_uri.view());
    return used == nullptr || (used->is_deprecated && used != &channel) ? nullptr : used;
}

const UserTokenPolicy* find_token_policy(const Array<UserTokenPolicy>& policies,
                                         const channel::SecuritySetting& security,
                                         const UserIdentity& identity)
{
    const UserTokenPolicy* best = nullptr;
    const crypto::SecurityPolicy* best_security = nullptr;
    for (const UserTokenPolicy& policy : policies) {
        const auto* used = token_security(policy, *security.policy, identity);
        // The table of policies is ordered from the weakest to the strongest.
        if (used != nullptr && is_for(policy, identity) && is_safe(*used, security, identity) &&
            (best == nullptr || used > best_security)) {
            best = &policy;
            best_security = used;
        }
    }
    return best;
}

Result<UserToken> make_user_token(const ConnectionConfig& config,
                                  const channel::ChannelEnvironment& environment,
                                  const UserTokenPolicy& policy, const ByteString& server_nonce)
{
    const channel::SecuritySetting& channel = config.channel.security;
    const auto* security = token_security(policy, *channel.policy, config.identity);
    if (security == nullptr || !is_safe(*security, channel, config.identity)) {
        return fail(status::Bad_SecurityPolicyRejected);
    }
    const TokenContext context{config, environment, policy, *security, server_nonce};
    return std::visit([&](const auto& user) { return make(context, user); }, config.identity);
}

} // namespace busbar::client::detail

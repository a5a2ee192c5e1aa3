#include "session.hpp"

#include <busbar/crypto/asymmetric.hpp>

namespace busbar::client::detail {

namespace {

constexpr std::size_t nonce_size = 32; // Part 4, 5.7.2: 32 bytes or more

ByteString chain_of(const channel::ApplicationIdentity& identity)
{
    std::vector<std::byte> chain;
    for (const crypto::Certificate& certificate : identity.certificates) {
        chain.insert(chain.end(), certificate.der().begin(), certificate.der().end());
    }
    return ByteString{chain};
}

std::vector<std::byte> join(std::span<const std::byte> a, std::span<const std::byte> b)
{
    std::vector<std::byte> joined{a.begin(), a.end()};
    joined.insert(joined.end(), b.begin(), b.end());
    return joined;
}

const crypto::SecurityPolicy& policy_of(const ConnectionConfig& config)
{
    return *config.channel.security.policy;
}

/// The first token policy of that kind in the endpoint that the channel uses.
const UserTokenPolicy* find_policy(const ConnectionConfig& config, const SessionData& session,
                                   UserTokenType type)
{
    for (const EndpointDescription& endpoint : session.endpoints) {
        if (endpoint.security_mode != config.channel.security.mode ||
            endpoint.security_policy_uri.view() != policy_of(config).uri) {
            continue;
        }
        for (const UserTokenPolicy& policy : endpoint.user_identity_tokens) {
            if (policy.token_type == type) {
                return &policy;
            }
        }
    }
    return nullptr;
}

Result<ExtensionObject> anonymous_token(const UserTokenPolicy& policy)
{
    AnonymousIdentityToken token;
    token.policy_id = policy.policy_id;
    return ExtensionObject::from(std::move(token));
}

Result<ExtensionObject> user_name_token(const ConnectionConfig& config, const SessionData& session,
                                        const UserTokenPolicy& token_policy, const NamedUser& user)
{
    UserNameIdentityToken token;
    token.policy_id = token_policy.policy_id;
    token.user_name = String{user.user_name};
    const std::span password = std::as_bytes(std::span{user.password});
    const auto* policy = token_policy.security_policy_uri.empty()
                             ? &policy_of(config)
                             : crypto::find_policy(token_policy.security_policy_uri.view());
    // A server cannot make us use a deprecated policy that we were not told to use.
    if (policy == nullptr || (policy->is_deprecated && policy != &policy_of(config))) {
        return fail(status::Bad_SecurityPolicyRejected);
    }
    if (policy->is_none() || !config.channel.server_certificate) {
        // A password in the clear is for the server to allow and for the channel to hide.
        if (config.channel.security.mode != MessageSecurityMode::SignAndEncrypt) {
            return fail(status::Bad_SecurityPolicyRejected);
        }
        token.password = ByteString{password};
        return ExtensionObject::from(std::move(token));
    }
    const auto secret = crypto::encrypt_secret(*policy, *config.channel.server_certificate,
                                               password, session.server_nonce.span());
    if (!secret) {
        return fail(secret.error());
    }
    token.password = ByteString{*secret};
    token.encryption_algorithm = String{policy->encryption_uri};
    return ExtensionObject::from(std::move(token));
}

} // namespace

Result<CreateSessionRequest> make_create_session(const ConnectionConfig& config,
                                                 const channel::ChannelEnvironment& environment,
                                                 SessionData& session)
{
    session.client_nonce.resize(nonce_size);
    const auto filled = environment.random->fill(session.client_nonce);
    if (!filled) {
        return fail(filled.error());
    }
    CreateSessionRequest request;
    request.client_description.application_uri = String{config.application_uri};
    request.client_description.application_name = LocalizedText{String{config.application_name}};
    request.client_description.application_type = ApplicationType::Client;
    request.endpoint_url = String{config.channel.endpoint_url};
    request.session_name = String{config.session_name};
    request.client_nonce = ByteString{session.client_nonce};
    if (environment.identity != nullptr && !policy_of(config).is_none()) {
        request.client_certificate = chain_of(*environment.identity);
        session.client_certificate = request.client_certificate;
    }
    request.requested_session_timeout = static_cast<double>(config.session_timeout.count());
    return request;
}

Result<void> accept_session(const ConnectionConfig& config, const CreateSessionResponse& response,
                            SessionData& session)
{
    session.authentication_token = response.authentication_token;
    session.server_nonce = response.server_nonce;
    session.endpoints = response.server_endpoints;
    const crypto::SecurityPolicy& policy = policy_of(config);
    if (policy.is_none()) {
        return {};
    }
    return crypto::asymmetric_verify(policy, *config.channel.server_certificate,
                                     join(session.client_certificate.span(), session.client_nonce),
                                     response.server_signature.signature.span());
}

Result<ActivateSessionRequest> make_activate_session(const ConnectionConfig& config,
                                                     const channel::ChannelEnvironment& environment,
                                                     const SessionData& session)
{
    const auto* user = std::get_if<NamedUser>(&config.identity);
    const bool is_named = user != nullptr;
    const auto* token_policy =
        find_policy(config, session, is_named ? UserTokenType::UserName : UserTokenType::Anonymous);
    if (token_policy == nullptr) {
        return fail(status::Bad_IdentityTokenRejected);
    }
    auto token = is_named ? user_name_token(config, session, *token_policy, *user)
                          : anonymous_token(*token_policy);
    if (!token) {
        return fail(token.error());
    }
    ActivateSessionRequest request;
    request.user_identity_token = *std::move(token);
    const crypto::SecurityPolicy& policy = policy_of(config);
    if (!policy.is_none()) {
        const auto signature = crypto::asymmetric_sign(
            policy, environment.identity->key,
            join(config.channel.server_certificate->der(), session.server_nonce.span()));
        if (!signature) {
            return fail(signature.error());
        }
        request.client_signature.algorithm = String{policy.signature_uri};
        request.client_signature.signature = ByteString{*signature};
    }
    return request;
}

} // namespace busbar::client::detail

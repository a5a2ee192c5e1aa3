#include "session.hpp"

#include <algorithm>
#include <cmath>

#include <busbar/client/endpoint_choice.hpp>
#include <busbar/core/text.hpp>
#include <busbar/crypto/asymmetric.hpp>

#include "user_token.hpp"

namespace busbar::client::detail {

namespace {

constexpr std::size_t client_nonce_size = 32; // Part 4, 5.7.2: 32 bytes or more

ByteString chain_of(const channel::ApplicationIdentity& identity)
{
    std::vector<std::byte> chain;
    for (const crypto::Certificate& certificate : identity.certificates) {
        chain.insert(chain.end(), certificate.der().begin(), certificate.der().end());
    }
    return ByteString{chain};
}

const crypto::SecurityPolicy& policy_of(const ConnectionConfig& config)
{
    return *config.channel.security.policy;
}

/// A server's value must not make us wait for ever, or never; an absurd one is replaced by the
/// requested one.
std::chrono::milliseconds session_timeout(const ConnectionConfig& config, double revised_ms)
{
    constexpr double least = 1'000;
    constexpr double most = 30.0 * 86'400'000;
    if (!std::isfinite(revised_ms) || revised_ms <= 0) {
        return config.session_timeout;
    }
    return std::chrono::milliseconds{
        static_cast<std::int64_t>(std::clamp(revised_ms, least, most))};
}

Result<void> refuse(const channel::ChannelEnvironment& environment, StatusCode status,
                    std::string_view check, std::string found)
{
    explain(*environment.log, "client",
            {status, check, std::move(found), "Part 4, 5.7.2.2",
             "Unless the connection is tampered with, the server is at fault"});
    return fail(status);
}

/// Checks that the certificate is that of the channel, and that its key has signed our nonce and
/// certificate.
Result<void> check_proof(const ConnectionConfig& config,
                         const channel::ChannelEnvironment& environment,
                         const CreateSessionResponse& response, const SessionData& session)
{
    const crypto::Certificate& server = *config.channel.server_certificate;
    const auto chain = crypto::parse_chain(response.server_certificate.span(), {&server, 1});
    if (!chain || !(chain->front() == server)) {
        return refuse(environment, status::Bad_CertificateInvalid, "server certificate",
                      "CreateSession returned another certificate than the channel's");
    }
    if (response.server_nonce.size() < crypto::min_server_nonce_size) {
        return refuse(environment, status::Bad_NonceInvalid, "server nonce",
                      std::to_string(response.server_nonce.size()) + " bytes, expected 32");
    }
    const auto fits = [&](std::span<const std::byte> certificate) {
        return crypto::asymmetric_verify(policy_of(config), server,
                                         join(certificate, session.client_nonce),
                                         response.server_signature.signature.span())
            .has_value();
    };
    // Servers sign either the chain that was sent, or its leaf.
    if (!fits(session.client_certificate.span()) &&
        !fits(environment.identity->certificates.front().der())) {
        return refuse(environment, status::Bad_SecurityChecksFailed, "server signature",
                      "it is not one over our certificate and nonce");
    }
    return {};
}

Result<void> check_session(const ConnectionConfig& config,
                           const channel::ChannelEnvironment& environment,
                           const CreateSessionResponse& response, const SessionData& session)
{
    if (response.authentication_token.is_null()) {
        return refuse(environment, status::Bad_UnknownResponse, "authentication token",
                      "CreateSession returned none");
    }
    if (!policy_of(config).is_none()) {
        if (auto proven = check_proof(config, environment, response, session); !proven) {
            return proven;
        }
    }
    if (config.discovered_endpoints.is_null()) {
        return {};
    }
    if (!check_endpoints(config.discovered_endpoints, response.server_endpoints)) {
        return refuse(environment, status::Bad_SecurityChecksFailed, "endpoints of the session",
                      "CreateSession returned others than GetEndpoints, whose answer may have been "
                      "changed on "
                      "its way");
    }
    return {};
}

/// Returns the token policy for the identity in the endpoint that the channel uses.
const UserTokenPolicy* token_policy(const ConnectionConfig& config, const SessionData& session)
{
    if (config.token_policy) {
        return &*config.token_policy;
    }
    for (const EndpointDescription& endpoint : session.endpoints) {
        if (endpoint.security_mode != config.channel.security.mode ||
            endpoint.security_policy_uri.view() != policy_of(config).uri) {
            continue;
        }
        if (const auto* found = find_token_policy(endpoint.user_identity_tokens,
                                                  config.channel.security, config.identity)) {
            return found;
        }
    }
    return nullptr;
}

} // namespace

Result<CreateSessionRequest> make_create_session(const ConnectionConfig& config,
                                                 const channel::ChannelEnvironment& environment,
                                                 SessionData& session)
{
    session.client_nonce.resize(client_nonce_size);
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
    request.max_response_message_size = config.channel.limits.max_message_size;
    return request;
}

Result<void> accept_session(const ConnectionConfig& config,
                            const channel::ChannelEnvironment& environment,
                            const CreateSessionResponse& response, SessionData& session)
{
    // The response may borrow from its message, copies own their memory.
    session.ticket.session_id = response.session_id;
    session.ticket.authentication_token = response.authentication_token;
    if (auto checked = check_session(config, environment, response, session); !checked) {
        return checked;
    }
    session.ticket.server_nonce = response.server_nonce;
    session.ticket.timeout = session_timeout(config, response.revised_session_timeout);
    session.endpoints = response.server_endpoints;
    return {};
}

Result<ActivateSessionRequest> make_activate_session(const ConnectionConfig& config,
                                                     const channel::ChannelEnvironment& environment,
                                                     const SessionData& session)
{
    const UserTokenPolicy* used = token_policy(config, session);
    if (used == nullptr) {
        return fail(status::Bad_IdentityTokenRejected);
    }
    auto user = make_user_token(config, environment, *used, session.ticket.server_nonce);
    if (!user) {
        return fail(user.error());
    }
    ActivateSessionRequest request;
    for (const std::string& locale : config.locale_ids) {
        request.locale_ids.push_back(String{locale});
    }
    request.user_identity_token = std::move(user->token);
    request.user_token_signature = std::move(user->signature);
    if (!policy_of(config).is_none()) {
        auto signature = sign(policy_of(config), environment.identity->key,
                              *config.channel.server_certificate, session.ticket.server_nonce);
        if (!signature) {
            return fail(signature.error());
        }
        request.client_signature = *std::move(signature);
    }
    return request;
}

Result<void> accept_activation(const ConnectionConfig& config,
                               const ActivateSessionResponse& response, SessionData& session)
{
    ByteString& last = session.ticket.server_nonce;
    const bool is_fresh = response.server_nonce.size() >= crypto::min_server_nonce_size &&
                          !std::ranges::equal(response.server_nonce.span(), last.span());
    // Without security nothing is signed with it, and small servers leave it out.
    if (!policy_of(config).is_none() && !is_fresh) {
        return fail(status::Bad_NonceInvalid);
    }
    last = response.server_nonce;
    return {};
}

} // namespace busbar::client::detail

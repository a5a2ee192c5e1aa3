#include "proxy_messages.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/encrypted_secret.hpp>
#include <busbar/harness/message_body.hpp>

#include "dissector.hpp"

namespace busbar::harness::detail {

namespace {

constexpr std::size_t max_proxy_secret_size = 8'192;
constexpr std::size_t max_proxy_sessions = 10'000;

std::vector<std::byte> joined(std::span<const std::byte> a, std::span<const std::byte> b)
{
    std::vector<std::byte> bytes{a.begin(), a.end()};
    bytes.insert(bytes.end(), b.begin(), b.end());
    return bytes;
}

ByteString chain_of(const channel::ApplicationIdentity* identity)
{
    std::vector<std::byte> chain;
    if (identity != nullptr) {
        for (const crypto::Certificate& certificate : identity->certificates) {
            chain.insert(chain.end(), certificate.der().begin(), certificate.der().end());
        }
    }
    return ByteString{chain};
}

/// Returns the setting of an endpoint; nothing if this build does not know its policy.
std::optional<channel::SecuritySetting> setting_of(const EndpointDescription& endpoint)
{
    const auto* const policy = crypto::find_policy(endpoint.security_policy_uri.view());
    const MessageSecurityMode mode = endpoint.security_mode;
    const bool is_none = mode == MessageSecurityMode::None;
    if (policy == nullptr || policy->is_none() != is_none || mode == MessageSecurityMode::Invalid) {
        return std::nullopt;
    }
    return channel::SecuritySetting{policy, mode};
}

bool is_for(const EndpointDescription& endpoint, const channel::SecuritySetting& security)
{
    return setting_of(endpoint) == security;
}

/// Replaces the body by the structure that `work` has changed.
template <typename Structure, typename Work>
Result<void> change_body(std::vector<std::byte>& body, Work work)
{
    auto structure = decode_body<Structure>(body);
    if (!structure) {
        return {}; // the receiver says what is wrong with it
    }
    if (Result<void> done = work(*structure); !done) {
        return done;
    }
    auto encoded = encode_body(*structure);
    if (!encoded) {
        return fail(encoded.error());
    }
    body = *std::move(encoded);
    return {};
}

/// The leaf of the client's channel as DER; empty without security.
ByteString client_leaf(const ProxyChannels& channels)
{
    return channels.client.empty() ? ByteString{} : ByteString{channels.client.front().der()};
}

template <typename Structure>
bool is_a(std::span<const std::byte> body)
{
    return encoding_of(body).is(Structure::binary_encoding_id);
}

} // namespace

ProxyMessages::ProxyMessages(Config config, const WallClock& clock, LogSink& log)
    : config_{std::move(config)}, own_chain_{chain_of(config_.identity)}, clock_{&clock}, log_{&log}
{
    if (config_.identity != nullptr) {
        own_uri_ = config_.identity->certificates.front().application_uri();
    }
    if (!config_.endpoints.empty()) {
        server_uri_ = config_.endpoints.front().server.application_uri;
    }
}

std::vector<channel::SecuritySetting> ProxyMessages::settings() const
{
    std::vector<channel::SecuritySetting> settings{{}};
    for (const EndpointDescription& endpoint : config_.endpoints) {
        const auto setting = setting_of(endpoint);
        const bool is_possible =
            setting && (setting->policy->is_none() ||
                        (config_.identity != nullptr && certificate_for(*setting).has_value()));
        if (is_possible &&
            std::find(settings.begin(), settings.end(), *setting) == settings.end()) {
            settings.push_back(*setting);
        }
    }
    return settings;
}

std::optional<crypto::Certificate>
ProxyMessages::certificate_for(const channel::SecuritySetting& security) const
{
    for (const EndpointDescription& endpoint : config_.endpoints) {
        if (is_for(endpoint, security)) {
            if (auto chain = crypto::parse_chain(endpoint.server_certificate.span())) {
                return std::move(chain->front());
            }
        }
    }
    return std::nullopt;
}

Result<void> ProxyMessages::from_client(const ProxyChannels& channels, ProxyExchange& exchange,
                                        std::vector<std::byte>& body) const
{
    binary::Reader reader{body};
    NodeId id;
    RequestHeader header;
    decode(reader, id);
    decode(reader, header);
    if (reader.ok()) {
        exchange.request_handle = header.request_handle;
        exchange.session = std::move(header.authentication_token);
    }
    if (is_a<CreateSessionRequest>(body)) {
        return change_body<CreateSessionRequest>(body, [&](CreateSessionRequest& request) {
            return change(channels, exchange, request);
        });
    }
    if (is_a<ActivateSessionRequest>(body)) {
        if (!decode_body<ActivateSessionRequest>(body)) {
            // It may have a password, which would be recorded.
            return refuse(status::Bad_DecodingError, "ActivateSession", "it cannot be decoded",
                          "Part 4, 5.7.3.2",
                          "Unless the client is tested for that, it is at fault");
        }
        return change_body<ActivateSessionRequest>(body, [&](ActivateSessionRequest& request) {
            return change(channels, exchange, request);
        });
    }
    const auto name_server = [&](auto& request) {
        request.endpoint_url = String{config_.server_url_text};
        return Result<void>{};
    };
    if (is_a<GetEndpointsRequest>(body)) {
        return change_body<GetEndpointsRequest>(body, name_server);
    }
    if (is_a<FindServersRequest>(body)) {
        return change_body<FindServersRequest>(body, name_server);
    }
    return {};
}

Result<void> ProxyMessages::change(const ProxyChannels& channels, ProxyExchange& exchange,
                                   CreateSessionRequest& request) const
{
    if (Result<void> checked = check_client(channels, request); !checked) {
        return checked;
    }
    exchange.client_nonce = request.client_nonce;
    exchange.client_certificate = request.client_certificate;
    request.endpoint_url = String{config_.server_url_text};
    if (request.server_uri.view() == own_uri_) {
        request.server_uri = server_uri_;
    }
    if (!request.client_certificate.empty() || !channels.security.policy->is_none()) {
        request.client_certificate = own_chain_;
        request.client_description.application_uri = String{own_uri_};
    }
    return {};
}

/// The server sees the proxy's certificate and ApplicationUri, and cannot check the client's.
Result<void> ProxyMessages::check_client(const ProxyChannels& channels,
                                         const CreateSessionRequest& request) const
{
    if (channels.client.empty()) {
        return {};
    }
    const crypto::Certificate& leaf = channels.client.front();
    const auto chain = crypto::parse_chain(request.client_certificate.span(), channels.client);
    if (!chain || chain->front() != leaf) {
        return refuse(status::Bad_SecurityChecksFailed, "client certificate",
                      "not the one that the channel was opened with", "Part 4, 5.7.2.2",
                      "The client mixes up its certificates");
    }
    const std::string_view uri = request.client_description.application_uri.view();
    if (!leaf.is_of_application(uri)) {
        return refuse(status::Bad_CertificateUriInvalid, "ApplicationUri",
                      "the client says " + printable(uri) + ", its certificate " +
                          printable(leaf.application_uri()),
                      "Part 4, 5.7.2.2 and 6.1.3",
                      "Set the client's ApplicationUri to that of its certificate");
    }
    return {};
}

Result<void> ProxyMessages::change(const ProxyChannels& channels, ProxyExchange& exchange,
                                   ActivateSessionRequest& request) const
{
    const crypto::SecurityPolicy& policy = *channels.security.policy;
    const ByteString nonce = nonce_of(exchange.session);
    // A session that the proxy does not know is one for the server to refuse.
    const auto known = sessions_.find(exchange.session);
    if (known != sessions_.end() && known->second.client != client_leaf(channels)) {
        return refuse(status::Bad_SecurityChecksFailed, "client certificate",
                      "not the one of the channel that the session was created on",
                      "Part 4, 5.7.3.1", "Let the client create a session of its own");
    }
    if (!policy.is_none() && !nonce.empty() && !channels.client.empty() &&
        !is_signed(policy, channels.client.front(), own_chain_.span(), nonce,
                   request.client_signature)) {
        return refuse(status::Bad_ApplicationSignatureInvalid, "client signature",
                      "it is not one over the proxy's certificate and the server's last nonce",
                      "Part 4, 5.7.3.2", "Unless the client is tested for that, it is at fault");
    }
    request.client_signature = {}; // to_server() makes one
    return take_secret(channels, exchange, request.user_identity_token);
}

Result<void> ProxyMessages::take_secret(const ProxyChannels& channels, ProxyExchange& exchange,
                                        ExtensionObject& token) const
{
    const ByteString nonce = nonce_of(exchange.session);
    if (token.get_if<X509IdentityToken>() != nullptr) {
        return refuse(status::Bad_IdentityTokenRejected, "user token",
                      "a user certificate, whose owner has signed for the proxy, and cannot sign "
                      "for the server",
                      "Part 4, 7.40.5", "Log in by name, or connect without the proxy");
    }
    if (const auto* const user = token.get_if<UserNameIdentityToken>()) {
        UserNameIdentityToken changed = *user;
        auto secret = open_secret(channels, nonce, changed.policy_id, changed.password,
                                  changed.encryption_algorithm);
        if (!secret) {
            return fail(secret.error());
        }
        exchange.secret = *std::move(secret);
        changed.password = {};
        changed.encryption_algorithm = {};
        token = ExtensionObject::from(std::move(changed));
    } else if (const auto* const issued = token.get_if<IssuedIdentityToken>()) {
        IssuedIdentityToken changed = *issued;
        auto secret = open_secret(channels, nonce, changed.policy_id, changed.token_data,
                                  changed.encryption_algorithm);
        if (!secret) {
            return fail(secret.error());
        }
        exchange.secret = *std::move(secret);
        changed.token_data = {};
        changed.encryption_algorithm = {};
        token = ExtensionObject::from(std::move(changed));
    } else if (!token.is_null() && token.get_if<AnonymousIdentityToken>() == nullptr) {
        return refuse(status::Bad_IdentityTokenInvalid, "user token",
                      "its type is unknown, or it cannot be decoded: it may have a secret",
                      "Part 4, 7.40.1", "Log in by name or as anonymous");
    }
    return {};
}

const crypto::SecurityPolicy* ProxyMessages::policy_of(const ProxyChannels& channels,
                                                       const String& policy_id) const
{
    const crypto::SecurityPolicy* found = channels.security.policy;
    for (const EndpointDescription& endpoint : config_.endpoints) {
        if (!is_for(endpoint, channels.security)) {
            continue;
        }
        for (const UserTokenPolicy& policy : endpoint.user_identity_tokens) {
            if (policy.policy_id == policy_id && !policy.security_policy_uri.empty()) {
                found = crypto::find_policy(policy.security_policy_uri.view());
            }
        }
    }
    return found != nullptr && !found->is_none() ? found : nullptr;
}

Result<ProxySecret> ProxyMessages::open_secret(const ProxyChannels& channels,
                                               const ByteString& nonce, const String& policy_id,
                                               const ByteString& data,
                                               const String& algorithm) const
{
    ProxySecret secret;
    const auto refused = [&](std::string found) {
        const auto result =
            refuse(status::Bad_IdentityTokenInvalid, "user token", std::move(found),
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
    secret.policy = policy_of(channels, policy_id);
    if (secret.policy == nullptr || config_.identity == nullptr) {
        return refused("its secret is encrypted, and its policy names no way that is known");
    }
    secret.form = is_sealed ? ProxySecret::Form::Sealed : ProxySecret::Form::Legacy;
    const channel::ApplicationIdentity& own = *config_.identity;
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

Result<void> ProxyMessages::put_secret(const ProxyChannels& channels, const ByteString& nonce,
                                       const ProxySecret& secret, ExtensionObject& token) const
{
    ByteString data{secret.text.span()};
    String algorithm;
    if (secret.form != ProxySecret::Form::Plain) {
        if (!channels.server) {
            return refuse(status::Bad_IdentityTokenRejected, "user token",
                          "the server shows no certificate to encrypt its secret for",
                          "Part 4, 7.40.2", "");
        }
        const bool is_sealed = secret.form == ProxySecret::Form::Sealed;
        auto encrypted =
            is_sealed ? crypto::seal_secret(*secret.policy, *channels.server, secret.text.span(),
                                            nonce.span(), clock_->now())
                      : crypto::encrypt_secret(*secret.policy, *channels.server, secret.text.span(),
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

Result<void> ProxyMessages::to_server(const ProxyChannels& channels, const ProxyExchange& exchange,
                                      std::vector<std::byte>& body) const
{
    if (!is_a<ActivateSessionRequest>(body)) {
        return {};
    }
    return change_body<ActivateSessionRequest>(
        body, [&](ActivateSessionRequest& request) -> Result<void> {
            const ByteString nonce = nonce_of(exchange.session);
            if (exchange.secret) {
                const auto put =
                    put_secret(channels, nonce, *exchange.secret, request.user_identity_token);
                if (!put) {
                    return put;
                }
            }
            if (channels.security.policy->is_none() || !channels.server) {
                return {};
            }
            auto signature = sign(*channels.security.policy, channels.server->der(), nonce);
            if (!signature) {
                return fail(signature.error());
            }
            request.client_signature = *std::move(signature);
            return {};
        });
}

Result<void> ProxyMessages::to_client(const ProxyChannels& channels, const ProxyExchange& exchange,
                                      std::vector<std::byte>& body)
{
    if (is_a<CreateSessionResponse>(body)) {
        return change_body<CreateSessionResponse>(body, [&](CreateSessionResponse& response) {
            return change(channels, exchange, response);
        });
    }
    if (is_a<ActivateSessionResponse>(body)) {
        if (const auto response = decode_body<ActivateSessionResponse>(body)) {
            remember(exchange.session, response->server_nonce, channels);
        }
        return {};
    }
    if (is_a<CloseSessionResponse>(body)) {
        sessions_.erase(exchange.session);
        return {};
    }
    if (is_a<GetEndpointsResponse>(body)) {
        return change_body<GetEndpointsResponse>(body, [&](GetEndpointsResponse& response) {
            rewrite(response.endpoints);
            return Result<void>{};
        });
    }
    if (is_a<FindServersResponse>(body)) {
        return change_body<FindServersResponse>(body, [&](FindServersResponse& response) {
            for (ApplicationDescription& server : response.servers) {
                rewrite(server);
            }
            return Result<void>{};
        });
    }
    return {};
}

Result<void> ProxyMessages::change(const ProxyChannels& channels, const ProxyExchange& exchange,
                                   CreateSessionResponse& response)
{
    const crypto::SecurityPolicy& policy = *channels.security.policy;
    if (!policy.is_none() && channels.server) {
        if (!is_signed(policy, *channels.server, own_chain_.span(), exchange.client_nonce,
                       response.server_signature)) {
            return refuse(status::Bad_ApplicationSignatureInvalid, "server signature",
                          "it is not one over the proxy's certificate and the client's nonce",
                          "Part 4, 5.7.2.2",
                          "Unless the server is tested for that, it is at fault");
        }
        auto signature = sign(policy, exchange.client_certificate.span(), exchange.client_nonce);
        if (!signature) {
            return fail(signature.error());
        }
        response.server_signature = *std::move(signature);
    }
    if (!response.server_certificate.empty()) {
        response.server_certificate = own_chain_;
    }
    rewrite(response.server_endpoints);
    remember(response.authentication_token, response.server_nonce, channels);
    return {};
}

std::vector<std::byte> ProxyMessages::fault(const ProxyExchange& exchange, StatusCode status) const
{
    ServiceFault fault;
    fault.response_header.timestamp = clock_->now();
    fault.response_header.request_handle = exchange.request_handle;
    fault.response_header.service_result = status;
    return encode_body(fault).value_or(std::vector<std::byte>{});
}

ByteString ProxyMessages::nonce_of(const NodeId& session) const
{
    const auto found = sessions_.find(session);
    return found == sessions_.end() ? ByteString{} : found->second.nonce;
}

void ProxyMessages::remember(const NodeId& session, const ByteString& nonce,
                             const ProxyChannels& channels)
{
    if (session.is_null() || nonce.empty()) {
        return;
    }
    if (sessions_.size() >= max_proxy_sessions && !sessions_.contains(session)) {
        sessions_.erase(
            std::min_element(sessions_.begin(), sessions_.end(), [](const auto& a, const auto& b) {
                return a.second.last_use < b.second.last_use;
            }));
    }
    sessions_.insert_or_assign(session, KnownSession{nonce, client_leaf(channels), ++last_use_});
}

bool ProxyMessages::is_signed(const crypto::SecurityPolicy& policy,
                              const crypto::Certificate& signer,
                              std::span<const std::byte> certificate, const ByteString& nonce,
                              const SignatureData& signature) const
{
    const auto fits = [&](std::span<const std::byte> signed_certificate) {
        return crypto::asymmetric_verify(policy, signer, joined(signed_certificate, nonce.span()),
                                         signature.signature.span())
            .has_value();
    };
    // Peers sign either the chain that was sent, or its leaf.
    return fits(certificate) ||
           (config_.identity != nullptr && fits(config_.identity->certificates.front().der()));
}

Result<SignatureData> ProxyMessages::sign(const crypto::SecurityPolicy& policy,
                                          std::span<const std::byte> certificate,
                                          const ByteString& nonce) const
{
    if (config_.identity == nullptr) {
        return fail(status::Bad_ConfigurationError);
    }
    const auto bytes =
        crypto::asymmetric_sign(policy, config_.identity->key, joined(certificate, nonce.span()));
    if (!bytes) {
        return fail(bytes.error());
    }
    SignatureData signature;
    signature.algorithm = String{policy.signature_uri};
    signature.signature = ByteString{*bytes};
    return signature;
}

Result<void> ProxyMessages::refuse(StatusCode status, std::string_view check, std::string found,
                                   std::string_view rule, std::string remedy) const
{
    explain(*log_, "proxy", {status, check, std::move(found), rule, std::move(remedy)});
    return fail(status);
}

bool ProxyMessages::is_of_server(std::string_view url) const
{
    const auto parsed = channel::EndpointUrl::parse(url);
    return parsed && parsed->port == config_.server_url.port;
}

void ProxyMessages::rewrite_url(String& url) const
{
    if (is_of_server(url.view())) {
        const auto parsed = channel::EndpointUrl::parse(url.view());
        url = String{config_.proxy_url + parsed->path};
    }
}

void ProxyMessages::rewrite(ApplicationDescription& server) const
{
    if (server.application_uri.view() != server_uri_) {
        return; // another server, which a discovery server knows
    }
    if (!own_uri_.empty()) {
        server.application_uri = String{own_uri_};
    }
    for (String& url : server.discovery_urls) {
        rewrite_url(url);
    }
}

void ProxyMessages::rewrite(Array<EndpointDescription>& endpoints) const
{
    const auto known = settings();
    Array<EndpointDescription> kept;
    for (EndpointDescription& endpoint : endpoints) {
        const bool is_ours = is_of_server(endpoint.endpoint_url.view());
        const auto setting = setting_of(endpoint);
        if (is_ours &&
            (!setting || std::find(known.begin(), known.end(), *setting) == known.end())) {
            continue;
        }
        if (is_ours) {
            rewrite_url(endpoint.endpoint_url);
            rewrite(endpoint.server);
            if (!endpoint.server_certificate.empty()) {
                endpoint.server_certificate = own_chain_;
            }
        }
        kept.push_back(std::move(endpoint));
    }
    endpoints = std::move(kept);
}

} // namespace busbar::harness::detail

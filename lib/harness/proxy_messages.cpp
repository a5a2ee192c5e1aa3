#include "proxy_messages.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/harness/message_body.hpp>

#include "dissector.hpp"
#include "session_proof.hpp"

namespace busbar::harness::detail {

namespace {

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

ProxyMessages::ProxyMessages(ProxyEndpoints::Config config, const WallClock& clock, LogSink& log)
    : endpoints_{std::move(config)}, secrets_{endpoints_, clock, log}, clock_{&clock}, log_{&log}
{
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
            return refuse_message(*log_, status::Bad_DecodingError, "ActivateSession",
                                  "it cannot be decoded", "Part 4, 5.7.3.2",
                                  "Unless the client is tested for that, it is at fault");
        }
        return change_body<ActivateSessionRequest>(body, [&](ActivateSessionRequest& request) {
            return change(channels, exchange, request);
        });
    }
    const auto name_server = [&](auto& request) {
        request.endpoint_url = String{endpoints_.server_url()};
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
    request.endpoint_url = String{endpoints_.server_url()};
    if (request.server_uri.view() == endpoints_.own_uri()) {
        request.server_uri = endpoints_.server_uri();
    }
    if (!request.client_certificate.empty() || !channels.security.policy->is_none()) {
        request.client_certificate = endpoints_.own_chain();
        request.client_description.application_uri = String{endpoints_.own_uri()};
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
        return refuse_message(*log_, status::Bad_SecurityChecksFailed, "client certificate",
                              "not the one that the channel was opened with", "Part 4, 5.7.2.2",
                              "The client mixes up its certificates");
    }
    const std::string_view uri = request.client_description.application_uri.view();
    if (!leaf.is_of_application(uri)) {
        return refuse_message(*log_, status::Bad_CertificateUriInvalid, "ApplicationUri",
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
        return refuse_message(*log_, status::Bad_SecurityChecksFailed, "client certificate",
                              "not the one of the channel that the session was created on",
                              "Part 4, 5.7.3.1", "Let the client create a session of its own");
    }
    if (!policy.is_none() && !nonce.empty() && !channels.client.empty() &&
        !is_signed(policy, channels.client.front(), nonce, request.client_signature)) {
        return refuse_message(
            *log_, status::Bad_ApplicationSignatureInvalid, "client signature",
            "it is not one over the proxy's certificate and the server's last nonce",
            "Part 4, 5.7.3.2", "Unless the client is tested for that, it is at fault");
    }
    request.client_signature = {}; // to_server() makes one
    auto secret = secrets_.take(channels.security, nonce, request.user_identity_token);
    if (!secret) {
        return fail(secret.error());
    }
    exchange.secret = *std::move(secret);
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
                    secrets_.put(*exchange.secret, channels.server ? &*channels.server : nullptr,
                                 nonce, request.user_identity_token);
                if (!put) {
                    return put;
                }
            }
            if (channels.security.policy->is_none() || !channels.server) {
                return {};
            }
            auto signature = sign_nonce(channels.security, endpoints_.identity(),
                                        channels.server->der(), nonce.span());
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
            endpoints_.rewrite(response.endpoints);
            return Result<void>{};
        });
    }
    if (is_a<FindServersResponse>(body)) {
        return change_body<FindServersResponse>(body, [&](FindServersResponse& response) {
            for (ApplicationDescription& server : response.servers) {
                endpoints_.rewrite(server);
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
        if (!is_signed(policy, *channels.server, exchange.client_nonce,
                       response.server_signature)) {
            return refuse_message(
                *log_, status::Bad_ApplicationSignatureInvalid, "server signature",
                "it is not one over the proxy's certificate and the client's nonce",
                "Part 4, 5.7.2.2", "Unless the server is tested for that, it is at fault");
        }
        auto signature =
            sign_nonce(channels.security, endpoints_.identity(), exchange.client_certificate.span(),
                       exchange.client_nonce.span());
        if (!signature) {
            return fail(signature.error());
        }
        response.server_signature = *std::move(signature);
    }
    if (!response.server_certificate.empty()) {
        response.server_certificate = endpoints_.own_chain();
    }
    endpoints_.rewrite(response.server_endpoints);
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
    if (sessions_.size() >= max_sessions && !sessions_.contains(session)) {
        sessions_.erase(
            std::min_element(sessions_.begin(), sessions_.end(), [](const auto& a, const auto& b) {
                return a.second.last_use < b.second.last_use;
            }));
    }
    sessions_.insert_or_assign(session, KnownSession{nonce, client_leaf(channels), ++last_use_});
}

bool ProxyMessages::is_signed(const crypto::SecurityPolicy& policy,
                              const crypto::Certificate& signer, const ByteString& nonce,
                              const SignatureData& signature) const
{
    return endpoints_.identity() != nullptr &&
           is_signed_nonce(policy, signer, *endpoints_.identity(), endpoints_.own_chain().span(),
                           nonce.span(), signature);
}

} // namespace busbar::harness::detail

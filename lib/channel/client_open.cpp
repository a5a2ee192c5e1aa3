#include <algorithm>
#include <utility>

#include <busbar/channel/server_certificate.hpp>
#include <busbar/core/text.hpp>

#include "client_impl.hpp"
#include "key_log.hpp"
#include "refusals.hpp"

namespace busbar::channel {

using namespace detail;

namespace {

/// With a shorter lifetime the client would request tokens without end.
constexpr std::chrono::milliseconds min_lifetime{1'000};

/// Refuses an answer to OpenSecureChannel that is negative or cannot be used.
Unexpected<Refusal> refuse_answer(StatusCode status, std::string found, std::string remedy = {})
{
    return refuse({status, "OpenSecureChannel response", std::move(found), "Part 4, 5.6.2",
                   std::move(remedy)});
}

constexpr std::string_view read_again =
    "Read the server's endpoints again; if it is not meant to have changed, do not trust it";

} // namespace

Result<void> ClientChannel::Impl::request_token(SecurityTokenRequestType type)
{
    const ChannelEnvironment& environment = conversation.environment();
    nonce = crypto::Secret{config.security.policy->nonce_size};
    if (!environment.random->fill(nonce.span())) {
        return fail(status::Bad_ResourceUnavailable);
    }
    OpenSecureChannelRequest request;
    request.request_header.timestamp = environment.wall_clock->now();
    request.request_type = type;
    request.security_mode = config.security.mode;
    request.client_nonce = ByteString{nonce.span()};
    request.requested_lifetime = static_cast<std::uint32_t>(
        std::clamp<std::int64_t>(config.requested_lifetime.count(), 0, UINT32_MAX));
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode_message(writer, request);
    auto body = sink.take(writer.written());
    open_request_id = next_request_id();
    const auto sent = conversation.send_open(
        open_request_id, body, config.server_certificate ? &*config.server_certificate : nullptr);
    crypto::cleanse(body);
    return sent;
}

/// Checks that the server has the certificate of the endpoint, and is trusted (Part 4, 6.1.3).
Checked<void> ClientChannel::Impl::check_server(const AsymmetricHeader& header)
{
    const ChannelEnvironment& environment = conversation.environment();
    const auto thumbprint = environment.identity->certificates.front().thumbprint();
    if (!std::ranges::equal(thumbprint, header.receiver_thumbprint)) {
        return refuse_answer(status::Bad_CertificateInvalid,
                             "it is encrypted for a certificate that is not this application's");
    }
    const crypto::Certificate& expected = *config.server_certificate;
    const auto chain = crypto::parse_chain(header.sender_certificate, {&expected, 1});
    if (!chain || !(chain->front() == expected)) {
        return refuse({status::Bad_CertificateInvalid, "server certificate",
                       "not the one that the server's endpoint showed", "Part 4, 5.5.1",
                       std::string{read_again}, printable(expected.subject()),
                       expected.thumbprint_text()});
    }
    auto valid = validate_server(environment, *chain, *header.policy, config.expected_server_uri,
                                 config.endpoint_url);
    if (valid) {
        conversation.peer_certificates = *chain;
    }
    return valid;
}

Checked<AsymmetricContent> ClientChannel::Impl::open_response(const Frame& frame)
{
    const auto header = parse_asymmetric_header(frame.bytes);
    if (!header || header->policy != config.security.policy) {
        return refuse_answer(status::Bad_SecurityChecksFailed, "it has another security policy");
    }
    const bool is_secure = !header->policy->is_none();
    if (is_secure) {
        if (auto checked = check_server(*header); !checked) {
            return refuse(std::move(checked).error());
        }
    }
    auto content = open_asymmetric(frame.bytes, *header,
                                   is_secure ? &conversation.environment().identity->key : nullptr,
                                   is_secure ? &*config.server_certificate : nullptr);
    if (!content) {
        return refuse_answer(content.error(), "its encryption or signature is wrong",
                             "The connection may have been tampered with on its way");
    }
    return *std::move(content);
}

Checked<void> ClientChannel::Impl::handle_open(const Frame& frame)
{
    auto content = open_response(frame);
    if (!content) {
        return refuse(std::move(content).error());
    }
    if (!conversation.accept_sequence(content->sequence_number)) {
        return refuse(protocol_refusal(status::Bad_SequenceNumberInvalid));
    }
    if (open_request_id == 0 || content->request_id != open_request_id) {
        return refuse_answer(status::Bad_SecurityChecksFailed, "nothing was asked");
    }
    if (const auto fault = decode_message<ServiceFault>(content->body)) {
        const StatusCode result = fault->response_header.service_result;
        return refuse_answer(result.is_bad() ? result : status::Bad_UnknownResponse,
                             "the server said no", "Its own log knows more");
    }
    const auto response = decode_message<OpenSecureChannelResponse>(content->body);
    if (!response) {
        return refuse(protocol_refusal(response.error()));
    }
    if (response->response_header.service_result.is_bad()) {
        return refuse_answer(response->response_header.service_result, "the server said no",
                             "Its own log knows more");
    }
    if (auto taken = take_token(*response); !taken) {
        return refuse(std::move(taken).error());
    }
    open_request_id = 0;
    const bool is_new = std::exchange(state, State::Open) == State::Opening;
    events.push({is_new ? ChannelEvent::Kind::Opened : ChannelEvent::Kind::Renewed, 0, {}, {}, {}});
    return {};
}

Checked<void> ClientChannel::Impl::take_token(const OpenSecureChannelResponse& response)
{
    const auto& issued = response.security_token;
    if (issued.channel_id == 0 ||
        (state == State::Open && issued.channel_id != conversation.channel_id)) {
        return refuse(protocol_refusal(status::Bad_TcpSecureChannelUnknown));
    }
    // Part 6, 6.7.4: it must have the policy's length, and be neither our own nor the previous one.
    if (!config.security.policy->is_none() &&
        (response.server_nonce.size() != nonce.size() || response.server_nonce == server_nonce ||
         std::ranges::equal(response.server_nonce.span(), nonce.span()))) {
        return refuse_answer(status::Bad_NonceInvalid,
                             "its nonce is short, or was used before (Part 6, 6.7.4)");
    }
    const auto lifetime =
        std::max(std::chrono::milliseconds{issued.revised_lifetime}, min_lifetime);
    auto token = make_token(issued.token_id, config.security,
                            {nonce.span(), response.server_nonce.span()}, lifetime, now);
    if (!token) {
        return refuse(protocol_refusal(token.error()));
    }
#ifdef BUSBAR_KEY_LOG
    log_keys(conversation.environment().key_log, Role::Client,
             {issued.channel_id,
              issued.token_id,
              config.security,
              {nonce.span(), response.server_nonce.span()}});
#endif
    conversation.channel_id = issued.channel_id;
    conversation.use(*std::move(token));
    server_nonce = response.server_nonce;
    return {};
}

} // namespace busbar::channel

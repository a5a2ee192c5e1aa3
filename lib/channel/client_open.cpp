#include <algorithm>
#include <utility>

#include "client_impl.hpp"

namespace busbar::channel {

using namespace detail;

namespace {

/// A server that grants less than this would be asked for tokens without end.
constexpr std::chrono::milliseconds min_lifetime{1'000};

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

/// The server must be the one whose certificate the endpoint showed, and trusted (Part 4, 6.1.3).
Result<void> ClientChannel::Impl::check_server(const AsymmetricHeader& header)
{
    const ChannelEnvironment& environment = conversation.environment();
    const auto thumbprint = environment.identity->certificates.front().thumbprint();
    if (!std::ranges::equal(thumbprint, header.receiver_thumbprint)) {
        return fail(status::Bad_CertificateInvalid);
    }
    const auto chain = crypto::parse_chain(header.sender_certificate);
    if (!chain || !(chain->front() == *config.server_certificate)) {
        return fail(status::Bad_CertificateInvalid);
    }
    const auto valid =
        environment.validator->validate(*chain, {header.policy, environment.wall_clock->now(), {}});
    if (valid) {
        conversation.peer_certificates = *chain;
    }
    return valid;
}

Result<AsymmetricContent> ClientChannel::Impl::open_response(const Frame& frame)
{
    const auto header = parse_asymmetric_header(frame.bytes);
    if (!header || header->policy != config.security.policy) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    if (header->policy->is_none()) {
        return open_asymmetric(frame.bytes, *header, nullptr, nullptr);
    }
    const auto checked = check_server(*header);
    if (!checked) {
        return fail(checked.error());
    }
    return open_asymmetric(frame.bytes, *header, &conversation.environment().identity->key,
                           &*config.server_certificate);
}

Result<void> ClientChannel::Impl::handle_open(const Frame& frame)
{
    const auto content = open_response(frame);
    if (!content) {
        return fail(content.error());
    }
    if (!conversation.accept_sequence(content->sequence_number)) {
        return fail(status::Bad_SequenceNumberInvalid);
    }
    if (open_request_id == 0 || content->request_id != open_request_id) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    if (const auto fault = decode_message<ServiceFault>(content->body)) {
        const StatusCode result = fault->response_header.service_result;
        return fail(result.is_bad() ? result : status::Bad_UnknownResponse);
    }
    const auto response = decode_message<OpenSecureChannelResponse>(content->body);
    if (!response) {
        return fail(response.error());
    }
    if (response->response_header.service_result.is_bad()) {
        return fail(response->response_header.service_result);
    }
    const auto taken = take_token(*response);
    if (!taken) {
        return taken;
    }
    open_request_id = 0;
    const bool is_new = std::exchange(state, State::Open) == State::Opening;
    events.push({is_new ? Event::Kind::Opened : Event::Kind::Renewed, 0, {}, {}, {}});
    return {};
}

Result<void> ClientChannel::Impl::take_token(const OpenSecureChannelResponse& response)
{
    const auto& issued = response.security_token;
    if (issued.channel_id == 0 ||
        (state == State::Open && issued.channel_id != conversation.channel_id)) {
        return fail(status::Bad_TcpSecureChannelUnknown);
    }
    // Part 6, 6.7.4: of the policy's length, and neither ours nor the one before come back.
    if (!config.security.policy->is_none() &&
        (response.server_nonce.size() != nonce.size() || response.server_nonce == server_nonce ||
         std::ranges::equal(response.server_nonce.span(), nonce.span()))) {
        return fail(status::Bad_NonceInvalid);
    }
    const auto lifetime =
        std::max(std::chrono::milliseconds{issued.revised_lifetime}, min_lifetime);
    auto token = make_token(issued.token_id, config.security,
                            {nonce.span(), response.server_nonce.span()}, lifetime, now);
    if (!token) {
        return fail(token.error());
    }
    conversation.channel_id = issued.channel_id;
    conversation.use(*std::move(token));
    server_nonce = response.server_nonce;
    return {};
}

} // namespace busbar::channel

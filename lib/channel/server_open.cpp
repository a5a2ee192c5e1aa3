#include <algorithm>

#include <busbar/channel/open_gate.hpp>

#include "channel_record.hpp"
#include "key_log.hpp"
#include "open_request.hpp"
#include "refusals.hpp"
#include "server_impl.hpp"

namespace busbar::channel {

using namespace detail;

Checked<void> ServerChannel::Impl::handle_open(const Frame& frame)
{
    const bool is_renewal = state == State::Open;
    const OpenContext context{config, is_renewal, client_nonce};
    auto header = read_open_header(frame, conversation, context);
    if (!header) {
        return refuse(std::move(header).error());
    }
    auto turned = has_turn(frame, *header);
    if (!turned) {
        return refuse(std::move(turned).error());
    }
    if (!*turned) {
        return {};
    }
    if (has_worker_for(*header->policy)) {
        return hand_over_request(frame, *header);
    }
    auto request = read_open_request(frame, *header, conversation, context);
    if (!request) {
        return refuse(std::move(request).error());
    }
    take_over(*request);
    auto answer = make_answer(std::move(request->body));
    const auto issued = answer ? issue(*std::move(answer), request->request_id)
                               : Result<void>{fail(answer.error())};
    if (!issued) {
        return refuse(protocol_refusal(issued.error()));
    }
    return {};
}

void ServerChannel::Impl::take_over(OpenRequest& request)
{
    conversation.security = request.security;
    conversation.peer_certificates = std::move(request.sender);
    conversation.channel_id = config.channel_id;
}

Result<OpenAnswer> ServerChannel::Impl::make_answer(OpenSecureChannelRequest request)
{
    const ChannelEnvironment& environment = conversation.environment();
    crypto::Secret nonce{conversation.security.policy->nonce_size};
    if (!environment.random->fill(nonce.span())) {
        return fail(status::Bad_ResourceUnavailable);
    }
    const auto lifetime = std::clamp(std::chrono::milliseconds{request.requested_lifetime},
                                     config.min_lifetime, config.max_lifetime);
    auto token = make_token(++last_token_id, conversation.security,
                            {nonce.span(), request.client_nonce.span()}, lifetime, now);
    if (!token) {
        return fail(token.error());
    }
#ifdef BUSBAR_KEY_LOG
    log_keys(environment.key_log, Role::Server,
             {config.channel_id,
              last_token_id,
              conversation.security,
              {nonce.span(), request.client_nonce.span()}});
#endif
    OpenSecureChannelResponse response;
    response.response_header.timestamp = environment.wall_clock->now();
    response.response_header.request_handle = request.request_header.request_handle;
    response.security_token.channel_id = config.channel_id;
    response.security_token.token_id = last_token_id;
    response.security_token.created_at = response.response_header.timestamp;
    response.security_token.revised_lifetime = static_cast<std::uint32_t>(lifetime.count());
    response.server_nonce = ByteString{nonce.span()};
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode_message(writer, response);
    return OpenAnswer{std::move(request), *std::move(token), sink.take(writer.written())};
}

Result<void> ServerChannel::Impl::issue(OpenAnswer answer, std::uint32_t request_id)
{
    const auto& peer = conversation.peer_certificates;
    const auto sent =
        conversation.send_open(request_id, answer.body, peer.empty() ? nullptr : &peer.front());
    crypto::cleanse(answer.body);
    if (!sent) {
        return sent;
    }
    put_in_force(std::move(answer));
    return {};
}

void ServerChannel::Impl::put_in_force(OpenAnswer answer)
{
    client_nonce = answer.request.client_nonce;
    conversation.offer(std::move(answer.token));
    const bool is_new = std::exchange(state, State::Open) == State::Opening;
    is_unproven = (std::exchange(is_at_work, false) && is_new) || is_unproven;
    record_issued(conversation, config.channel_id, answer.request, is_new);
    events.push({is_new ? ChannelEvent::Kind::Opened : ChannelEvent::Kind::Renewed, 0, {}, {}, {}});
}

void ServerChannel::Impl::advance(TimePoint time)
{
    now = time;
    if (conversation.is_held && turn <= now) {
        conversation.is_held = false;
    }
}

Checked<bool> ServerChannel::Impl::has_turn(const Frame& frame, const AsymmetricHeader& header)
{
    OpenGate* const gate = conversation.environment().gate;
    if (gate == nullptr || header.policy->is_none()) {
        return true;
    }
    if (std::exchange(turn, no_deadline) != no_deadline) { // it has waited
        is_at_work = true;
        return true;
    }
    const bool is_renewal = state == State::Open;
    const Duration longest = is_renewal ? Duration::max() : handshake_deadline - now;
    const OpenGate::Admission admission = gate->admit(is_renewal, longest, now);
    if (!admission.is_admitted) {
        is_refusal_known = admission.is_known;
        return refuse(protocol_refusal(status::Bad_TcpServerTooBusy));
    }
    if (admission.wait <= Duration::zero()) {
        is_at_work = true;
        return true;
    }
    turn = now + admission.wait;
    conversation.hold(frame);
    return false;
}

void ServerChannel::Impl::prove()
{
    if (std::exchange(is_unproven, false)) {
        conversation.environment().gate->worked();
    }
}

void ServerChannel::Impl::report_failure()
{
    const bool has_worked_in_vain = std::exchange(is_at_work, false);
    if (std::exchange(is_unproven, false) || has_worked_in_vain) { // one failure in either case
        conversation.environment().gate->failed(now);
    }
}

} // namespace busbar::channel

#include "open_request.hpp"

#include <algorithm>

namespace busbar::channel::detail {

namespace {

/// Part 6, 6.7.7: channel and policy, and that a renewal keeps the policy.
Result<void> check_header(const AsymmetricHeader& header, const Conversation& conversation,
                          const OpenContext& context)
{
    const auto& allowed = context.config.allowed;
    if (header.channel_id != (context.is_renewal ? context.config.channel_id : 0)) {
        return fail(status::Bad_TcpSecureChannelUnknown);
    }
    if (std::none_of(allowed.begin(), allowed.end(),
                     [&](const SecuritySetting& s) { return s.policy == header.policy; })) {
        return fail(status::Bad_SecurityPolicyRejected);
    }
    if (context.is_renewal && header.policy != conversation.security.policy) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    return {};
}

/// The client's certificates, trusted; none with policy None.
Result<crypto::CertificateChain> check_sender(const AsymmetricHeader& header,
                                              const Conversation& conversation, bool is_renewal)
{
    const ChannelEnvironment& environment = conversation.environment();
    if (header.policy->is_none()) {
        return crypto::CertificateChain{};
    }
    if (environment.identity == nullptr || environment.validator == nullptr) {
        return fail(status::Bad_SecurityPolicyRejected);
    }
    const crypto::Certificate& own = environment.identity->certificates.front();
    if (!std::ranges::equal(own.thumbprint(), header.receiver_thumbprint)) {
        return fail(status::Bad_CertificateInvalid);
    }
    auto chain = crypto::parse_chain(header.sender_certificate);
    if (!chain) {
        return fail(chain.error());
    }
    // A message of the server that comes back to it is no client.
    if (chain->front() == own) {
        return fail(status::Bad_CertificateUseNotAllowed);
    }
    if (is_renewal && !(*chain == conversation.peer_certificates)) {
        return fail(status::Bad_CertificateInvalid);
    }
    const auto valid =
        environment.validator->validate(*chain, {header.policy, environment.wall_clock->now(), {}});
    if (!valid) {
        return fail(valid.error());
    }
    return chain;
}

/// Part 4, 5.6.2.2: type, mode and nonce.
Result<void> check_body(const OpenSecureChannelRequest& request, const AsymmetricHeader& header,
                        const Conversation& conversation, const OpenContext& context)
{
    const SecuritySetting wanted{header.policy, request.security_mode};
    const auto& allowed = context.config.allowed;
    const auto expected =
        context.is_renewal ? SecurityTokenRequestType::Renew : SecurityTokenRequestType::Issue;
    if (request.request_type != expected) {
        return fail(status::Bad_RequestTypeInvalid);
    }
    if (header.policy->is_none() != (request.security_mode == MessageSecurityMode::None) ||
        std::find(allowed.begin(), allowed.end(), wanted) == allowed.end()) {
        return fail(status::Bad_SecurityModeRejected);
    }
    if (context.is_renewal && !(wanted == conversation.security)) {
        return fail(status::Bad_SecurityModeRejected);
    }
    // Part 6, 6.7.4: of the policy's length, and never the same twice.
    if (!header.policy->is_none() && (request.client_nonce.size() != header.policy->nonce_size ||
                                      request.client_nonce == context.last_nonce)) {
        return fail(status::Bad_NonceInvalid);
    }
    return {};
}

} // namespace

Result<OpenRequest> read_open_request(const Frame& frame, Conversation& conversation,
                                      const OpenContext& context)
{
    const auto header = parse_asymmetric_header(frame.bytes);
    if (!header) {
        return fail(header.error());
    }
    const auto admissible = check_header(*header, conversation, context);
    if (!admissible) {
        return fail(admissible.error());
    }
    auto sender = check_sender(*header, conversation, context.is_renewal);
    if (!sender) {
        return fail(sender.error());
    }
    const ApplicationIdentity* const identity = conversation.environment().identity;
    const auto content =
        open_asymmetric(frame.bytes, *header, identity != nullptr ? &identity->key : nullptr,
                        sender->empty() ? nullptr : &sender->front());
    if (!content) {
        return fail(content.error());
    }
    if (!conversation.accept_sequence(content->sequence_number)) {
        return fail(status::Bad_SequenceNumberInvalid);
    }
    auto body = decode_message<OpenSecureChannelRequest>(content->body);
    if (!body) {
        return fail(body.error());
    }
    const auto checked = check_body(*body, *header, conversation, context);
    if (!checked) {
        return fail(checked.error());
    }
    return OpenRequest{{header->policy, body->security_mode},
                       *std::move(sender),
                       content->request_id,
                       *std::move(body)};
}

} // namespace busbar::channel::detail

#include "open_request.hpp"

#include <algorithm>
#include <optional>

#include <busbar/core/text.hpp>

#include "refusals.hpp"

namespace busbar::channel::detail {

namespace {

/// Invalid is a number like any other here: no peer may request it.
std::string mode_text(MessageSecurityMode mode)
{
    const std::string_view known = mode == MessageSecurityMode::Invalid ? "" : name(mode);
    return known.empty() ? "mode " + std::to_string(static_cast<std::int32_t>(mode))
                         : std::string{known};
}

Unexpected<Refusal> refuse_certificate(StatusCode status, std::string found, std::string_view rule,
                                       std::string remedy,
                                       const crypto::Certificate* certificate = nullptr)
{
    Refusal refusal{status, "sender certificate", std::move(found), rule, std::move(remedy)};
    if (certificate != nullptr) {
        refusal.subject = printable(certificate->subject());
        refusal.thumbprint = certificate->thumbprint_text();
    }
    return refuse(std::move(refusal));
}

Unexpected<Refusal> refuse_policy(const AsymmetricHeader& header)
{
    return refuse(
        {status::Bad_SecurityPolicyRejected, "security policy",
         std::string{header.policy->name} + " is not offered here",
         "Part 4, 5.6.2.2 and Part 6, 6.7.2.3",
         "Choose another policy in the peer's settings, or add an endpoint with this one"});
}

/// Part 6, 6.7.7: channel and policy, and that a renewal keeps the policy.
Checked<void> check_header(const AsymmetricHeader& header, const Conversation& conversation,
                           const OpenContext& context)
{
    const auto& allowed = context.config.allowed;
    if (header.channel_id != (context.is_renewal ? context.config.channel_id : 0)) {
        return refuse(protocol_refusal(status::Bad_TcpSecureChannelUnknown));
    }
    if (std::none_of(allowed.begin(), allowed.end(),
                     [&](const SecuritySetting& s) { return s.policy == header.policy; })) {
        return refuse_policy(header);
    }
    if (context.is_renewal && header.policy != conversation.security.policy) {
        return refuse({status::Bad_SecurityChecksFailed,
                       "security policy",
                       std::string{header.policy->name} + " for a channel that has " +
                           std::string{conversation.security.policy->name},
                       "Part 4, 5.6.2.1: renewal",
                       {}});
    }
    return {};
}

/// Part 6, 6.7.2.3: the message is for this server's certificate.
Checked<void> check_receiver(const AsymmetricHeader& header, const ChannelEnvironment& environment)
{
    if (header.policy->is_none()) {
        return {};
    }
    if (environment.identity == nullptr || environment.validator == nullptr) {
        return refuse_policy(header);
    }
    const crypto::Certificate& own = environment.identity->certificates.front();
    if (!std::ranges::equal(own.thumbprint(), header.receiver_thumbprint)) {
        return refuse({status::Bad_CertificateInvalid, "receiver certificate thumbprint",
                       "the message is encrypted for a certificate that is not this server's",
                       "Part 6, 6.7.2.3",
                       "Let the peer read this server's endpoints again: it has an old certificate",
                       printable(own.subject()), own.thumbprint_text()});
    }
    return {};
}

/// Part 4, 5.6.2.2: checks type, mode and nonce.
Checked<void> check_body(const OpenSecureChannelRequest& request,
                         const crypto::SecurityPolicy& policy, const Conversation& conversation,
                         const OpenContext& context)
{
    const SecuritySetting wanted{&policy, request.security_mode};
    const auto& allowed = context.config.allowed;
    const auto expected =
        context.is_renewal ? SecurityTokenRequestType::Renew : SecurityTokenRequestType::Issue;
    if (request.request_type != expected) {
        return refuse({status::Bad_RequestTypeInvalid,
                       "request type",
                       context.is_renewal ? "Issue on an open channel" : "Renew without a channel",
                       "Part 4, 5.6.2.2",
                       {}});
    }
    const bool is_allowed =
        policy.is_none() == (request.security_mode == MessageSecurityMode::None) &&
        std::find(allowed.begin(), allowed.end(), wanted) != allowed.end() &&
        (!context.is_renewal || wanted == conversation.security);
    if (!is_allowed) {
        return refuse(
            {status::Bad_SecurityModeRejected, "security mode",
             mode_text(request.security_mode) + " with " + std::string{policy.name} +
                 (context.is_renewal ? " differs from the channel's" : " is not offered here"),
             "Part 4, 5.6.2.2",
             "Choose another mode in the peer's settings, or add an endpoint with it"});
    }
    // Part 6, 6.7.4: it must have the policy's length, and not be used twice.
    const bool has_length = request.client_nonce.size() == policy.nonce_size;
    if (!policy.is_none() && (!has_length || request.client_nonce == context.last_nonce)) {
        return refuse({status::Bad_NonceInvalid,
                       "client nonce",
                       std::to_string(request.client_nonce.size()) + " bytes where " +
                           std::to_string(policy.nonce_size) +
                           " new ones were expected, or the previous nonce was sent again",
                       "Part 6, 6.7.4",
                       {}});
    }
    return {};
}

/// Decryption and signature are refused alike, here too: neither takes longer.
Checked<AsymmetricContent> check_content(Result<AsymmetricContent> content,
                                         const crypto::CertificateChain& sender)
{
    if (content) {
        return *std::move(content);
    }
    Refusal refusal{
        content.error(), "OpenSecureChannel encryption and signature",
        "not encrypted for this server's key, or not signed with the key of the "
        "sender's certificate",
        "Part 6, 6.7.7",
        "Check that the peer's private key belongs to its certificate; if it does, the connection "
        "may have been tampered with"};
    if (!sender.empty()) {
        refusal.subject = printable(sender.front().subject());
        refusal.thumbprint = sender.front().thumbprint_text();
    }
    return refuse(std::move(refusal));
}

} // namespace

Checked<AsymmetricHeader> read_open_header(const Frame& frame, const Conversation& conversation,
                                           const OpenContext& context)
{
    const auto header = parse_asymmetric_header(frame.bytes);
    if (!header) {
        return refuse(header.error() == status::Bad_SecurityPolicyRejected
                          ? Refusal{header.error(), "security policy", "an unknown one",
                                    "Part 6, 6.7.2.3",
                                    "Choose another policy in the peer's settings"}
                          : protocol_refusal(header.error()));
    }
    if (auto admissible = check_header(*header, conversation, context); !admissible) {
        return refuse(std::move(admissible).error());
    }
    if (auto own = check_receiver(*header, conversation.environment()); !own) {
        return refuse(std::move(own).error());
    }
    return *header;
}

Checked<OpenSender> read_open_sender(const AsymmetricHeader& header,
                                     const Conversation& conversation, const OpenContext& context)
{
    const ChannelEnvironment& environment = conversation.environment();
    if (header.policy->is_none()) {
        return OpenSender{};
    }
    const crypto::Certificate& own = environment.identity->certificates.front();
    crypto::KnownCertificates* const known = context.config.known_certificates;
    auto chain = crypto::parse_chain(header.sender_certificate,
                                     known != nullptr ? known->certificates()
                                                      : conversation.peer_certificates);
    if (!chain) {
        return refuse_certificate(chain.error(),
                                  "no X.509 certificate, or more than one and its issuers",
                                  "Part 4, 6.1.3, Table 100: Certificate Structure",
                                  "The peer needs another certificate");
    }
    const crypto::Certificate* const leaf = &chain->front();
    // The server's own message that is sent back to it does not come from a client.
    if (*leaf == own) {
        return refuse_certificate(status::Bad_CertificateUseNotAllowed,
                                  "this server's own certificate", "Part 6, 6.7.7",
                                  "Every application needs a certificate of its own", leaf);
    }
    if (context.is_renewal && !(*chain == conversation.peer_certificates)) {
        return refuse_certificate(status::Bad_CertificateInvalid,
                                  "another certificate than the channel was opened with",
                                  "Part 4, 5.6.2.1: renewal", {}, leaf);
    }
    auto valid = environment.validator->validate(
        *chain, {.policy = header.policy,
                 .now = environment.wall_clock->now(),
                 .application_uri = {},
                 .purpose = crypto::CertificatePurpose::ClientApplication,
                 .source = context.config.source});
    if (valid && known != nullptr) {
        known->keep(*chain);
    }
    OpenSender sender{*std::move(chain), {}};
    if (!valid) {
        sender.objection = std::move(valid).error();
    }
    return sender;
}

Checked<OpenRequest> judge_open_request(Result<AsymmetricContent> opened, OpenSender sender,
                                        const crypto::SecurityPolicy& policy,
                                        Conversation& conversation, const OpenContext& context)
{
    auto content = check_content(std::move(opened), sender.certificates);
    // Part 6, 6.7.7 checks the certificate first. The result is used only now: a refusal for that
    // takes as long as one for what the private key found (Part 2, 6.3).
    if (sender.objection) {
        return refuse(*std::move(sender.objection));
    }
    if (!content) {
        return refuse(std::move(content).error());
    }
    if (!conversation.accept_sequence(content->sequence_number)) {
        return refuse(protocol_refusal(status::Bad_SequenceNumberInvalid));
    }
    auto body = decode_message<OpenSecureChannelRequest>(content->body);
    if (!body) {
        return refuse(protocol_refusal(body.error()));
    }
    if (auto checked = check_body(*body, policy, conversation, context); !checked) {
        return refuse(std::move(checked).error());
    }
    return OpenRequest{{&policy, body->security_mode},
                       std::move(sender.certificates),
                       content->request_id,
                       *std::move(body)};
}

Checked<OpenRequest> read_open_request(const Frame& frame, const AsymmetricHeader& header,
                                       Conversation& conversation, const OpenContext& context)
{
    auto sender = read_open_sender(header, conversation, context);
    if (!sender) {
        return refuse(std::move(sender).error());
    }
    const ApplicationIdentity* const identity = conversation.environment().identity;
    const crypto::CertificateChain& chain = sender->certificates;
    auto opened =
        open_asymmetric(frame.bytes, header, identity != nullptr ? &identity->key : nullptr,
                        chain.empty() ? nullptr : &chain.front());
    return judge_open_request(std::move(opened), *std::move(sender), *header.policy, conversation,
                              context);
}

} // namespace busbar::channel::detail

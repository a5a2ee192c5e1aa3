#include <algorithm>

#include <busbar/core/text.hpp>

#include "link.hpp"
#include "session_proof.hpp"
#include "session_services.hpp"
#include "user_token.hpp"

namespace busbar::server::detail {

namespace {

constexpr std::size_t server_nonce_size = 32;
constexpr std::size_t max_locale_size = 32;

/// ActivateSession (Part 4, 5.6.3).
class ActivateSession final : public OperationOf<ActivateSessionRequest> {
public:
    void start(ServiceContext& context) override;
    [[nodiscard]] TimePoint next_deadline() const override { return answer_at_; }
    void handle_deadline(TimePoint) override { fault(status::Bad_UserAccessDenied); }

private:
    [[nodiscard]] Result<UserIdentity> log_in_user(const ServiceContext& context) const;
    void refuse(ServiceContext& context);
    void accept(ServiceContext& context, UserIdentity user);

    TimePoint answer_at_{no_deadline};
};

/// Whether the session may be used over this channel, the client being who it says. The first time
/// it has to be the channel it was created over, later one with the same security and certificate.
StatusCode check_channel(const ServiceContext& context)
{
    const Core& core = context.core;
    const Session& session = *context.session;
    const channel::ServerChannel& channel = context.link.channel();
    if (session.link == &context.link) {
        return status::Good;
    }
    if (!session.is_activated) {
        return status::Bad_SecureChannelIdInvalid;
    }
    const crypto::CertificateChain& peer = channel.peer_certificates();
    const bool is_same_client = peer.empty()
                                    ? session.client_certificate.empty()
                                    : !session.client_certificate.empty() &&
                                          peer.front() == session.client_certificate.front();
    if (channel.security() != session.security || !is_same_client) {
        return status::Bad_SecurityChecksFailed;
    }
    return core.sessions.count_of(context.link) < core.limits().max_sessions_per_channel
               ? status::Good
               : status::Bad_TooManySessions;
}

/// Over another channel a session keeps its user (Part 4, 5.6.3.1); one without a user has nothing
/// but its token to prove it, which mode Sign lets others read.
StatusCode check_user(const ServiceContext& context, const UserIdentity& user)
{
    const Session& session = *context.session;
    if (session.link == &context.link) {
        return status::Good;
    }
    if (user.token_type != session.user.token_type || user.name != session.user.name) {
        return status::Bad_IdentityChangeNotSupported;
    }
    return user.token_type == UserTokenType::Anonymous &&
                   session.security.mode == MessageSecurityMode::Sign
               ? status::Bad_SecurityModeInsufficient
               : status::Good;
}

void ActivateSession::start(ServiceContext& context)
{
    const Session& session = *context.session;
    if (const StatusCode status = check_channel(context); status.is_bad()) {
        return fault(status);
    }
    if (!is_signed_by_client(context.core, session.security, session.client_certificate,
                             session.server_nonce.span(), request().client_signature)) {
        return fault(status::Bad_ApplicationSignatureInvalid);
    }
    auto user = log_in_user(context);
    if (!user && user.error() == status::Bad_UserAccessDenied) {
        return refuse(context);
    }
    if (!user) {
        return fault(user.error());
    }
    if (const StatusCode status = check_user(context, *user); status.is_bad()) {
        return fault(status);
    }
    accept(context, *std::move(user));
}

Result<UserIdentity> ActivateSession::log_in_user(const ServiceContext& context) const
{
    const Core& core = context.core;
    const Session& session = *context.session;
    const auto& endpoints = core.config.endpoints;
    const auto endpoint = std::find_if(endpoints.begin(), endpoints.end(), [&](const auto& e) {
        return e.security == session.security;
    });
    if (endpoint == endpoints.end()) {
        return fail(status::Bad_SecurityPolicyRejected);
    }
    const ExtensionObject& token = request().user_identity_token;
    if (token.get_if<UserNameIdentityToken>() != nullptr &&
        core.logins.is_locked(context.link.login_key(), context.now)) {
        return fail(status::Bad_UserAccessDenied);
    }
    return log_in({*endpoint, core.environment.users,
                   core.config.identity ? &core.config.identity->key : nullptr,
                   session.server_nonce.span()},
                  token);
}

/// Part 4, 5.6.3.1 wants guessing to be slow: the answer waits.
void ActivateSession::refuse(ServiceContext& context)
{
    Core& core = context.core;
    const Duration delay = core.logins.failed(context.link.login_key(), context.now);
    core.log(LogLevel::Warning, "session",
             "login refused from " + std::string{context.link.peer_address()});
    if (delay == Duration::zero()) {
        return fault(status::Bad_UserAccessDenied);
    }
    answer_at_ = context.now + delay;
}

void ActivateSession::accept(ServiceContext& context, UserIdentity user)
{
    Core& core = context.core;
    Session& session = *context.session;
    auto nonce = random_bytes(core, server_nonce_size);
    if (!nonce) {
        return fault(nonce.error());
    }
    if (user.token_type == UserTokenType::UserName) {
        core.logins.succeeded(context.link.login_key());
    }
    if (!request().locale_ids.empty()) { // else the old ones stay
        session.locale_ids.clear();
        for (const String& locale : request().locale_ids) {
            if (session.locale_ids.size() < core.limits().max_locale_ids &&
                locale.size() <= max_locale_size) {
                session.locale_ids.push_back(locale.str());
            }
        }
    }
    session.user = std::move(user);
    session.server_nonce = *std::move(nonce);
    session.is_activated = true;
    session.link = &context.link;
    session.deadline = context.now + session.timeout;
    core.log(LogLevel::Info, "session",
             "\"" + printable(session.name) + "\" activated by " +
                 (session.user.token_type == UserTokenType::Anonymous
                      ? "an anonymous user"
                      : "user \"" + printable(session.user.name) + "\""));
    respond<ActivateSessionResponse>([&](binary::Writer& writer) {
        encode(writer, session.server_nonce);
        encode(writer, Array<StatusCode>{}); // of software certificates
        encode(writer, Array<DiagnosticInfo>{});
    });
}

} // namespace

std::unique_ptr<Operation> make_activate_session()
{
    return std::make_unique<ActivateSession>();
}

} // namespace busbar::server::detail

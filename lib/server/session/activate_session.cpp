#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>

#include "server/users/user_token.hpp"
#include "session_proof.hpp"
#include "session_record.hpp"
#include "session_services.hpp"

namespace busbar::server::detail {

namespace {

constexpr std::size_t server_nonce_size = 32;
constexpr std::size_t max_locale_size = 32;

Refusal refusal_of(StatusCode status, std::string_view check, std::string found,
                   std::string remedy = {})
{
    return {status, check, std::move(found), "Part 4, 5.7.3.1", std::move(remedy)};
}

/// Returns the token without its proof of identity (Part 5, 6.4.10).
ExtensionObject without_secret(const ExtensionObject& token)
{
    if (const auto* const user = token.get_if<UserNameIdentityToken>()) {
        UserNameIdentityToken shown = *user;
        shown.password = {};
        return ExtensionObject::from(std::move(shown));
    }
    if (const auto* const issued = token.get_if<IssuedIdentityToken>()) {
        IssuedIdentityToken shown = *issued;
        shown.token_data = {};
        return ExtensionObject::from(std::move(shown));
    }
    const bool has_no_secret = token.get_if<AnonymousIdentityToken>() != nullptr ||
                               token.get_if<X509IdentityToken>() != nullptr;
    return has_no_secret ? token : ExtensionObject{};
}

/// ActivateSession (Part 4, 5.7.3).
///
/// Guessing must be slow: an attempt may have to wait before it is checked, and a refusal before it
/// is answered. An attempt that has waited is checked from the beginning, as if it had just
/// arrived. A worker may check passwords meanwhile.
class ActivateSession final : public OperationOf<ActivateSessionRequest>,
                              private WorkOwner,
                              private CheckWaiter {
public:
    explicit ActivateSession(const SessionNeeds& needs) : needs_{needs} {}
    ~ActivateSession() override
    {
        needs_.password_checks.stop_waiting(*this);
        if (check_) {
            check_->leave();
        }
        wipe_message();
    }
    /// The message without the password, which only the token's own policy encrypts.
    [[nodiscard]] std::vector<std::byte> spare_message() override
    {
        wipe_message();
        return take_message();
    }
    void start(ServiceContext& context) override
    {
        peer_ = &context.peer;
        mark_ = context.mark;
        attempt(context.now);
    }
    [[nodiscard]] TimePoint next_deadline() const override { return wait_until_; }
    void handle_deadline(TimePoint now) override
    {
        wait_until_ = no_deadline;
        if (answer_ != StatusCode{}) {
            return fault(answer_);
        }
        attempt(now);
    }

private:
    void attempt(TimePoint now);
    [[nodiscard]] std::optional<Refusal> check_channel() const;
    [[nodiscard]] std::optional<Refusal> check_signature() const;
    [[nodiscard]] std::optional<Refusal> check_user(const UserIdentity& user) const;
    [[nodiscard]] bool may_log_in(TimePoint now);
    [[nodiscard]] LoginStep begin_user() const;
    void start_check(std::shared_ptr<PasswordCheck> check, TimePoint now);
    void work_done(TimePoint now) override;
    void take_result(PasswordCheck& check, TimePoint now);
    void work_displaced(TimePoint now) override;
    void check_ended(TimePoint now) override;
    void end_user(Login user, TimePoint now);
    [[nodiscard]] bool is_anonymous() const;
    [[nodiscard]] LoginAttempt login_attempt() const;
    void refuse(StatusCode answer, Refusal refusal, Duration delay, TimePoint now);
    void refuse(Refusal refusal, TimePoint now);
    void tell_refused(StatusCode answer, Refusal refusal);
    void ends_with(StatusCode status) override;
    [[nodiscard]] std::vector<std::string> chosen_locales() const;
    void accept(UserIdentity user, TimePoint now);

    const SessionNeeds& needs_;
    Peer* peer_{nullptr};
    std::string thumbprint_;
    RequestMark mark_;
    TimePoint wait_until_{no_deadline};
    bool has_waited_{false};
    /// The check that a worker does, and the nonce that it began with.
    std::shared_ptr<PasswordCheck> check_;
    ByteString checked_nonce_;
    /// The delay of the answer if the password is wrong.
    Duration delay_{};
    /// The answer at the end of the wait; good if that is not decided.
    StatusCode answer_;
    /// True once there is a record of its result.
    bool is_told_{false};
};

const EndpointConfig* find_endpoint(const ServerConfig& config, const Session& session)
{
    const auto& endpoints = config.endpoints;
    const auto found = std::find_if(endpoints.begin(), endpoints.end(), [&](const auto& endpoint) {
        return endpoint.security == session.security;
    });
    return found == endpoints.end() ? nullptr : &*found;
}

/// Checks that the session may be used over this channel, by its own client. The first time it must
/// be the channel it was created over, later one with the same security and certificate.
std::optional<Refusal> ActivateSession::check_channel() const
{
    constexpr std::string_view check = "channel of the session";
    const Session& session = *this->session();
    if (session.peer == peer_) {
        return std::nullopt;
    }
    if (!session.is_activated) {
        return refusal_of(status::Bad_SecureChannelIdInvalid, check,
                          "the first activation came over another channel than CreateSession");
    }
    const channel::ServerChannel& channel = peer_->channel();
    const crypto::CertificateChain& peer = channel.peer_certificates();
    const bool is_same_client = peer.empty()
                                    ? session.client_certificate.empty()
                                    : !session.client_certificate.empty() &&
                                          peer.front() == session.client_certificate.front();
    if (!is_same_client) {
        return refusal_of(status::Bad_SecurityChecksFailed, check,
                          "the new channel has another client certificate");
    }
    if (channel.security() != session.security) {
        return refusal_of(status::Bad_SecurityChecksFailed, check,
                          "the new channel has another security policy or mode");
    }
    if (peer_->sessions().size() >= needs_.limits().max_sessions_per_channel) {
        return refusal_of(status::Bad_TooManySessions, check,
                          "the new channel is full of sessions");
    }
    return std::nullopt;
}

std::optional<Refusal> ActivateSession::check_signature() const
{
    const Session& session = *this->session();
    if (is_signed_by_client(needs_.config.identity ? &*needs_.config.identity : nullptr,
                            session.security, session.client_certificate,
                            session.server_nonce.span(), request().client_signature)) {
        return std::nullopt;
    }
    return refusal_of(status::Bad_ApplicationSignatureInvalid, "client signature",
                      "it was not made with the key of the client's certificate over the server's "
                      "certificate and last nonce");
}

/// Over another channel a session keeps its user; a session without a user is proved by its token
/// alone, which mode Sign lets others read.
std::optional<Refusal> ActivateSession::check_user(const UserIdentity& user) const
{
    constexpr std::string_view check = "user of the session";
    const Session& session = *this->session();
    if (session.peer == peer_) {
        return std::nullopt;
    }
    if (!is_same_user(user, session.user)) {
        return refusal_of(status::Bad_IdentityChangeNotSupported, check,
                          "over the new channel another user logs in");
    }
    if (user.token_type == UserTokenType::Anonymous &&
        session.security.mode == MessageSecurityMode::Sign) {
        return refusal_of(status::Bad_SecurityModeInsufficient, check,
                          "an anonymous session cannot change to a new channel in mode Sign");
    }
    return std::nullopt;
}

bool ActivateSession::is_anonymous() const
{
    const ExtensionObject& token = request().user_identity_token;
    return token.is_null() || token.get_if<AnonymousIdentityToken>() != nullptr;
}

LoginAttempt ActivateSession::login_attempt() const
{
    const auto* user = request().user_identity_token.get_if<UserNameIdentityToken>();
    const std::string_view name = user != nullptr ? user->user_name.view() : std::string_view{};
    const bool has_code = user != nullptr && needs_.environment.users != nullptr &&
                          needs_.environment.users->has_code(name);
    return {name, thumbprint_, peer_->address(), has_code};
}

/// Returns false if the attempt must wait, or was refused, before it is checked.
bool ActivateSession::may_log_in(TimePoint now)
{
    if (is_anonymous()) {
        return true;
    }
    if (const auto& peer = peer_->channel().peer_certificates(); !peer.empty()) {
        thumbprint_ = peer.front().thumbprint_text();
    }
    const LoginAttempt attempt = login_attempt();
    const LoginGuard::Admission admission = needs_.logins.admit(attempt, now);
    if (admission.is_locked) {
        refuse(status::Bad_UserAccessDenied,
               refusal_of(status::Bad_UserAccessDenied, "login lock-out",
                          "user \"" + printable(attempt.user) + "\" after too many failures",
                          "Wait, or restart the server"),
               admission.delay, now);
        return false;
    }
    if (admission.has_to_wait) {
        needs_.password_checks.wait(*this);
        return false;
    }
    if (admission.delay != Duration::zero() && !std::exchange(has_waited_, true)) {
        wait_until_ = now + admission.delay;
        return false;
    }
    return true;
}

LoginStep ActivateSession::begin_user() const
{
    const Session& session = *this->session();
    const EndpointConfig* endpoint = find_endpoint(needs_.config, session);
    if (endpoint == nullptr) {
        return Login{Unexpected{
            LoginFailure{status::Bad_SecurityPolicyRejected,
                         refusal_of(status::Bad_SecurityPolicyRejected, "endpoint of the session",
                                    "there is no endpoint with the security of the channel")}}};
    }
    return begin_log_in({needs_.config, *endpoint, needs_.environment.users,
                         session.server_nonce.span(), needs_.wall_time(), needs_.log_in_issued},
                        request().user_identity_token, request().user_token_signature);
}

void ActivateSession::attempt(TimePoint now)
{
    if (auto refusal = check_channel()) {
        return refuse(*std::move(refusal), now);
    }
    if (auto refusal = check_signature()) {
        return refuse(*std::move(refusal), now);
    }
    if (!may_log_in(now)) {
        return;
    }
    needs_.guards.request().forget();
    LoginStep step = begin_user();
    if (needs_.guards.request().is_noted()) {
        return fault(status::Bad_InternalError);
    }
    if (auto* login = std::get_if<Login>(&step)) {
        return end_user(std::move(*login), now);
    }
    start_check(std::get<std::shared_ptr<PasswordCheck>>(std::move(step)), now);
}

void ActivateSession::start_check(std::shared_ptr<PasswordCheck> check, TimePoint now)
{
    UserStore& users = *needs_.environment.users;
    Worker* const worker = needs_.password_checks.worker_for(users);
    if (worker == nullptr) {
        check->run(needs_.guards.unguarded_users());
        return end_user(end_log_in(*check), now);
    }
    const LoginAttempt attempt = login_attempt();
    check_ = std::move(check);
    busbar::detail::Undo undo{[this] {
        const std::shared_ptr<PasswordCheck> begun = std::exchange(check_, nullptr);
        needs_.password_checks.forget(*begun); // it may wait there without this object
        begun->end(LoginGuard::End::NotLookedAt);
    }};
    delay_ = check_->begin(needs_.logins, attempt, now);
    check_->owner = this;
    check_->source = LoginGuard::source_of(attempt);
    check_->rank = needs_.logins.knows(check_->source) ? 1 : 0;
    check_->users = &needs_.guards.unguarded_users();
    checked_nonce_ = session()->server_nonce;
    const auto run = [&](std::function<void()> job) {
        return needs_.guards.report().guard("Worker::run", false,
                                            [&] { return worker->run(std::move(job)); });
    };
    if (!needs_.password_checks.start(check_, run, now)) {
        return fault(status::Bad_ServerTooBusy);
    }
    undo.keep();
}

void ActivateSession::check_ended(TimePoint now)
{
    if (is_finished()) {
        return;
    }
    const StatusCode thrown =
        busbar::detail::guarded(needs_.log, "a login that has waited", [&] { attempt(now); });
    if (thrown.is_bad()) {
        fault(thrown);
    }
}

/// Much may have happened meanwhile.
void ActivateSession::work_done(TimePoint now)
{
    const std::shared_ptr<PasswordCheck> check = check_;
    if (!is_finished()) {
        const StatusCode thrown = busbar::detail::guarded(needs_.log, "the end of a login",
                                                          [&] { take_result(*check, now); });
        if (thrown.is_bad()) {
            fault(thrown);
        }
    }
    check_ = nullptr;
    // Others may wait for the end of a check that has decided nothing.
    busbar::detail::attempt([&] { check->end_by_result(); });
}

void ActivateSession::take_result(PasswordCheck& check, TimePoint now)
{
    if (auto refusal = check_channel()) {
        return refuse(*std::move(refusal), now);
    }
    if (session()->server_nonce != checked_nonce_) {
        return refuse(refusal_of(status::Bad_ApplicationSignatureInvalid, "client signature",
                                 "its nonce was used while the password was checked"),
                      now);
    }
    end_user(end_log_in(check), now);
}

void ActivateSession::work_displaced(TimePoint now)
{
    const std::shared_ptr<PasswordCheck> check = std::exchange(check_, nullptr);
    busbar::detail::attempt([&] { check->end(LoginGuard::End::NotLookedAt); });
    if (is_finished()) {
        return;
    }
    // An exception would end the login that took the place.
    busbar::detail::attempt([&] {
        busbar::detail::Undo undo{[&] { fault(status::Bad_ServerTooBusy); }};
        refuse(refusal_of(status::Bad_ServerTooBusy, "place for a login",
                          "no other client has as many logins waiting, and others wait too",
                          "Let the client try again later"),
               now);
        undo.keep();
    });
}

void ActivateSession::end_user(Login user, TimePoint now)
{
    if (!user) {
        Duration delay = Duration::zero();
        if (check_) {
            delay = user.error().is_guess ? delay_ : Duration::zero();
            check_->end(user.error().is_guess ? LoginGuard::End::Wrong
                                              : LoginGuard::End::NotLookedAt);
        } else if (user.error().is_guess) {
            delay = needs_.logins.failed(login_attempt(), now);
        }
        return refuse(user.error().answer, std::move(user.error().refusal), delay, now);
    }
    if (auto refusal = check_user(*user)) {
        return refuse(*std::move(refusal), now);
    }
    accept(*std::move(user), now);
}

void ActivateSession::refuse(Refusal refusal, TimePoint now)
{
    const StatusCode answer = refusal.status;
    refuse(answer, std::move(refusal), Duration::zero(), now);
}

void ActivateSession::refuse(StatusCode answer, Refusal refusal, Duration delay, TimePoint now)
{
    tell_refused(answer, std::move(refusal));
    if (delay == Duration::zero()) {
        return fault(answer);
    }
    answer_ = answer;
    wait_until_ = now + delay;
    deadline_changed();
}

/// A guess must not be without a record because its client does not await the answer.
void ActivateSession::ends_with(StatusCode status)
{
    if (!is_told_ && peer_ != nullptr && session() != nullptr) {
        tell_refused(status, refusal_of(status, "login", "it ended before it was decided"));
    }
}

void ActivateSession::tell_refused(StatusCode answer, Refusal refusal)
{
    refusal.found +=
        ", in session \"" + printable(session()->name) + "\" from " + std::string{peer_->address()};
    Record record{RecordKind::LoginRefused, LogLevel::Warning, "session"};
    record.status = answer;
    record.refusal = &refusal;
    record.actor = actor_of(*session(), mark_);
    const std::string claimed{login_attempt().user};
    record.actor.user = claimed;
    record.actor.address = peer_->address();
    record.actor.secure_channel_id = peer_->channel().channel_id();
    record.certificate = certificate_of(*session());
    const std::array fields{
        RecordField{"UserIdentityToken", Variant{without_secret(request().user_identity_token)}}};
    record.fields = fields;
    is_told_ = true;
    tell(needs_.log, record);
}

std::vector<std::string> ActivateSession::chosen_locales() const
{
    if (request().locale_ids.empty()) { // the old ones stay
        return session()->locale_ids;
    }
    std::vector<std::string> chosen;
    for (const String& locale : request().locale_ids) {
        if (chosen.size() < needs_.limits().max_locale_ids && locale.size() <= max_locale_size) {
            chosen.push_back(locale.str());
        }
    }
    return chosen;
}

void ActivateSession::accept(UserIdentity user, TimePoint now)
{
    Session& session = *this->session();
    auto nonce = random_bytes(*needs_.environment.random, server_nonce_size);
    if (!nonce) {
        return fault(nonce.error());
    }
    if (check_) {
        check_->end(LoginGuard::End::Right);
    } else if (!is_anonymous()) {
        needs_.logins.succeeded(login_attempt());
    }
    if (!make_share(needs_, session, user, peer_->address())) {
        const std::string most = std::to_string(needs_.limits().max_sessions_per_user);
        return refuse(refusal_of(status::Bad_TooManySessions, "place for a session",
                                 describe(user) + " has " + most + " sessions, which is the limit",
                                 "Close sessions that are not needed, or raise the limit "
                                 "max_sessions_per_user"),
                      now);
    }
    std::vector<std::string> locales = chosen_locales();
    const bool is_first = !std::exchange(session.is_activated, true);
    busbar::detail::Undo undo{[&] { session.is_activated = !is_first; }};
    peer_->bind(session);
    set_user(needs_, *find_endpoint(needs_.config, session), session, std::move(user), now);
    undo.keep();
    session.have_all_memory();
    session.locale_ids = std::move(locales);
    is_told_ = true;
    busbar::detail::attempt([&] {
        tell_activated(needs_, session, is_first, mark_,
                       without_secret(request().user_identity_token));
    });
    needs_.keeper.session_activated(session);
    // Even for the same user, whose rights may have changed.
    if (session.is_user_untold) {
        needs_.keeper.user_changed(session, now);
        session.is_user_untold = false;
    }
    session.server_nonce = *std::move(nonce); // a refused client signs the previous one
    const bool must_change = session.user.must_change_password;
    respond_with<ActivateSessionResponse>(
        must_change ? status::Good_PasswordChangeRequired : status::Good,
        [&](binary::Writer& writer) {
            encode(writer, session.server_nonce);
            encode(writer, Array<StatusCode>{}); // for software certificates
            encode(writer, Array<DiagnosticInfo>{});
        });
}

} // namespace

std::unique_ptr<ServiceOperation> make_activate_session(const SessionNeeds& needs)
{
    return std::make_unique<ActivateSession>(needs);
}

} // namespace busbar::server::detail

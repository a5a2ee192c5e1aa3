#include <algorithm>
#include <string>

#include <busbar/core/record.hpp>
#include <busbar/server/config_check.hpp>
#include <busbar/server/running_server.hpp>

#include "server/rights/method_lookup.hpp"
#include "server/session/session.hpp"
#include "server/session/session_services.hpp"
#include "server_impl.hpp"

/// Changes a server while it runs.
namespace busbar::server {

namespace {

/// Long enough for pending answers.
constexpr Duration old_channel_time = std::chrono::seconds{1};
/// Maximum number of references that are visited to find a Method, as for a Call.
constexpr std::size_t most_visits = 10'000'000;

bool is_same_certificate(const ServerConfig& a, const ServerConfig& b)
{
    if (!a.identity || !b.identity) {
        return a.identity.has_value() == b.identity.has_value();
    }
    return a.identity->certificates == b.identity->certificates;
}

/// Returns whether the names differ from those that the certificate was checked for.
bool has_other_names(const ServerConfig& a, const ServerConfig& b)
{
    return a.host_names != b.host_names || a.endpoint_url != b.endpoint_url;
}

/// Returns null if it is over.
const detail::Session* find_session(const detail::Core& core, const NodeId& session_id)
{
    const auto& all = core.sessions.all();
    const auto found = std::find_if(
        all.begin(), all.end(), [&](const auto& entry) { return entry.second->id == session_id; });
    return found == all.end() ? nullptr : found->second.get();
}

/// Returns the thumbprint of the client's certificate; empty if it has none.
std::string thumbprint_of(const detail::Session& session)
{
    if (session.peer == nullptr) {
        return {};
    }
    const auto& chain = session.peer->channel().peer_certificates();
    return chain.empty() ? std::string{} : chain.front().thumbprint_text();
}

} // namespace

Configured<void> Server::Impl::check_change(const ServerConfig& wanted) const
{
    if (wanted.application_uri != config.application_uri) {
        return misconfigured("application_uri", "cannot change while the server runs");
    }
    if (wanted.limits.max_assembly != config.limits.max_assembly) {
        return misconfigured("limits.max_assembly", "cannot change while the server runs");
    }
    if (auto checked = check_config(wanted, environment); !checked) {
        return checked;
    }
    return check_modules(wanted);
}

Configured<void> RunningServer::check(const ServerConfig& config) const
{
    return impl_->check_change(config);
}

Configured<void> RunningServer::reconfigure(ServerConfig config) const
{
    if (auto checked = impl_->check_change(config); !checked) {
        return checked;
    }
    const bool is_same = is_same_certificate(impl_->config, config);
    const bool has_other_hosts = has_other_names(impl_->config, config);
    impl_->config = std::move(config);
    if (!is_same) {
        impl_->first_new_link_id = impl_->next_link_id;
        impl_->old_channels_deadline = impl_->latest + old_channel_time;
    }
    if (!is_same || has_other_hosts) {
        impl_->watch_certificate(impl_->latest);
    }
    impl_->homeless_deadline = impl_->latest;
    impl_->claim();
    Record record{RecordKind::SettingsChanged, LogLevel::Info, "server"};
    record.text = is_same ? "has another configuration"
                          : "has another configuration and another certificate: channels are "
                            "closed, sessions stay";
    tell(*impl_->environment.log, record);
    impl_->sweep();
    return {};
}

/// Includes channels that are being opened now, which may have been told the old certificate.
void Server::Impl::close_old_channels()
{
    old_channels_deadline = no_deadline;
    for (detail::PeerLink* link : links) {
        const auto* policy = link->channel().security().policy;
        if (link->id() < first_new_link_id && !link->is_closed() && policy != nullptr &&
            !policy->is_none()) {
            link->close(status::Bad_SecureChannelClosed, "the server has another certificate");
        }
    }
    sweep();
}

void Server::Impl::close_untrusted_channels()
{
    trust_check_deadline = no_deadline;
    for (detail::PeerLink* link : links) {
        const auto* policy = link->channel().security().policy;
        const crypto::CertificateChain& chain = link->channel().peer_certificates();
        if (link->is_closed() || policy == nullptr || policy->is_none() || chain.empty()) {
            continue;
        }
        crypto::ValidationContext context;
        context.policy = policy;
        context.now = environment.wall_clock->now();
        context.purpose = crypto::CertificatePurpose::ClientApplication;
        if (const auto valid = environment.validator->validate(chain, context); !valid) {
            Record record{RecordKind::CertificateRefused, LogLevel::Warning, "server"};
            record.text = "closes a channel: " + text(valid.error());
            record.status = valid.error().status;
            record.refusal = &valid.error();
            record.certificate = chain.front().der();
            tell(link->log(), record);
            link->close(status::Bad_SecurityChecksFailed, "the client is not trusted any more");
        }
    }
    sweep();
}

void RunningServer::trust_changed() const
{
    impl_->trust_check_deadline = impl_->latest + old_channel_time;
}

void Server::Impl::end_homeless_sessions()
{
    homeless_deadline = no_deadline;
    static_cast<void>(end_sessions(
        status::Bad_SecurityPolicyRejected, false, [&](const detail::Session& session) {
            return std::none_of(config.endpoints.begin(), config.endpoints.end(),
                                [&](const EndpointConfig& endpoint) {
                                    return endpoint.security == session.security;
                                });
        }));
}

std::size_t Server::Impl::end_sessions(StatusCode status, bool deletes_subscriptions,
                                       FunctionRef<bool(const detail::Session&)> which)
{
    std::vector<NodeId> tokens;
    for (const auto& [token, session] : sessions.all()) {
        if (which(*session)) {
            tokens.push_back(token);
        }
    }
    for (const NodeId& token : tokens) {
        if (detail::Session* session = sessions.find(token)) {
            close_session(*session, status, deletes_subscriptions);
        }
    }
    sweep();
    return tokens.size();
}

std::size_t RunningServer::end_sessions(FunctionRef<bool(const UserIdentity&)> whose) const
{
    return impl_->end_sessions(status::Bad_UserAccessDenied, true,
                               [&](const detail::Session& session) {
                                   return session.is_activated && whose(session.user);
                               });
}

void RunningServer::visit_users(FunctionRef<void(const UserIdentity&)> visit) const
{
    for (const auto& [token, session] : impl_->sessions.all()) {
        if (session->is_activated) {
            visit(session->user);
        }
    }
}

void RunningServer::roles_changed() const
{
    for (const auto& [token, session] : impl_->sessions.all()) {
        if (!session->is_activated) {
            continue;
        }
        UserIdentity user = with_roles(impl_->session_needs, *session, session->granted);
        if (!(user == session->user)) {
            session->user = std::move(user);
            impl_->user_changed(*session, impl_->latest);
        }
    }
    impl_->sweep();
}

TimePoint RunningServer::latest_time() const
{
    return impl_->latest;
}

StatusCode RunningServer::check_call(const NodeId& session_id, const NodeId& object,
                                     const NodeId& method) const
{
    const detail::Session* const session = find_session(*impl_, session_id);
    if (session == nullptr) {
        return status::Bad_SessionClosed;
    }
    const model::AddressSpace& space = impl_->address_space;
    if (space.find(object) == model::no_node || space.find(method) == model::no_node) {
        return status::Good;
    }
    const detail::NodeRights rights = detail::rights_of(*session, space, impl_->environment.access);
    std::size_t visits = most_visits;
    const auto found = detail::find_method(space, rights, object, method, visits);
    if (!found) {
        return found.error();
    }
    const StatusCode weak = rights.check_channel(*found);
    return weak.is_bad() || detail::is_user_executable(space, rights, *found)
               ? weak
               : StatusCode{status::Bad_UserAccessDenied};
}

std::optional<PasswordTrial> RunningServer::begin_password_trial(const NodeId& session_id) const
{
    const detail::Session* const session = find_session(*impl_, session_id);
    if (session == nullptr) {
        return std::nullopt;
    }
    PasswordTrial trial{session->user.name, thumbprint_of(*session), session->address};
    const detail::LoginAttempt attempt{trial.user, trial.certificate, trial.address};
    return impl_->logins.admit(attempt, impl_->latest).is_locked ? std::nullopt
                                                                 : std::optional{std::move(trial)};
}

void RunningServer::password_tried(const PasswordTrial& trial, bool was_right) const
{
    const detail::LoginAttempt attempt{trial.user, trial.certificate, trial.address};
    if (was_right) {
        impl_->logins.succeeded(attempt);
    } else {
        static_cast<void>(impl_->logins.failed(attempt, impl_->latest));
    }
}

std::optional<std::uint32_t> RunningServer::user_number(const NodeId& session_id) const
{
    const detail::Session* const session = find_session(*impl_, session_id);
    return session == nullptr ? std::nullopt : std::optional{session->user_changes};
}

std::string RunningServer::share_key(const NodeId& session_id) const
{
    const detail::Session* const session = find_session(*impl_, session_id);
    return session == nullptr ? std::string{} : detail::share_key(session->user, session->address);
}

} // namespace busbar::server

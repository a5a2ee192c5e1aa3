#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>
#include <busbar/crypto/certificate_notices.hpp>

#include "core/utf8.hpp"

#include "session_proof.hpp"
#include "session_record.hpp"
#include "session_services.hpp"

namespace busbar::server::detail {

namespace {

/// Sizes of nonces and tokens in bytes (Part 4, 5.7.2.2 and 7.35).
constexpr std::size_t nonce_size = 32;
constexpr std::size_t max_nonce_size = 128;
constexpr std::size_t max_text_size = 256;
/// Bytes that may wait before a session is activated, in requests of the largest size allowed then.
constexpr std::uint64_t sessionless_requests = 16;

/// The channel must have the security of an endpoint: discovery may have less.
Checked<void> check_endpoint(const ServerConfig& config, const channel::SecuritySetting& security)
{
    const auto& endpoints = config.endpoints;
    const bool is_there = std::any_of(endpoints.begin(), endpoints.end(),
                                      [&](const auto& e) { return e.security == security; });
    if (!is_there) {
        return refuse({status::Bad_SecurityPolicyRejected, "security of the session",
                       "the channel has " + std::string{security.policy->name} +
                           ", which is for discovery only",
                       "Part 4, 5.5.1 and 5.7.2", "Let the client choose one of the endpoints"});
    }
    return {};
}

Checked<void> check_nonce(const ByteString& nonce, bool is_secure)
{
    const bool is_right =
        nonce.empty() ? !is_secure : nonce.size() >= nonce_size && nonce.size() <= max_nonce_size;
    if (!is_right) {
        return refuse({status::Bad_NonceInvalid,
                       "client nonce",
                       std::to_string(nonce.size()) + " bytes, expected 32 to 128",
                       "Part 4, 5.7.2.2",
                       {}});
    }
    return {};
}

/// Part 4, 5.7.2.2: the nonce must be new, or its signature proves nothing.
Checked<void> use_nonce(SessionTable& sessions, const ByteString& nonce)
{
    if (!sessions.nonces.take(nonce.span())) {
        return refuse({status::Bad_NonceInvalid, "client nonce",
                       "the same as for one of the last sessions", "Part 4, 5.7.2.2",
                       "Let the client make a random nonce for each session"});
    }
    return {};
}

/// Returns whether `sent` is the leaf of `known`, alone or with issuers: those of the channel, or
/// others, which are not used but must be certificates.
bool begins_with(std::span<const std::byte> sent, const crypto::CertificateChain& known)
{
    const auto chain = crypto::parse_chain(sent, known); // which parses nothing twice
    return chain && !known.empty() && chain->front() == known.front();
}

/// The client's certificate must be that of its channel, and name the application that the client
/// claims to be (Part 4, 5.7.2.2).
Checked<void> check_certificate(const channel::ServerChannel& channel,
                                const CreateSessionRequest& request)
{
    const crypto::CertificateChain& known = channel.peer_certificates();
    if (!begins_with(request.client_certificate.span(), known)) {
        return refuse({status::Bad_SecurityChecksFailed, "client certificate",
                       "not the one that the channel was opened with", "Part 4, 5.7.2.2",
                       "The client mixes up its certificates"});
    }
    const crypto::Certificate& leaf = known.front();
    if (!leaf.is_of_application(request.client_description.application_uri.view())) {
        return refuse({status::Bad_CertificateUriInvalid, "ApplicationUri",
                       "the client says " +
                           printable(request.client_description.application_uri.view()) +
                           ", its certificate " + printable(leaf.application_uri()),
                       "Part 4, 5.7.2.2 and 6.1.3",
                       "Set the client's ApplicationUri to that of its certificate, or make it "
                       "another certificate",
                       printable(leaf.subject()), leaf.thumbprint_text()});
    }
    return {};
}

/// Part 4, 5.7.2.2: a client behind a gateway names the server that it wants.
Checked<void> check_server_uri(const ServerConfig& config, const String& wanted)
{
    if (!wanted.empty() && wanted.view() != config.application_uri) {
        return refuse({status::Bad_ServerUriInvalid, "ServerUri",
                       "the client wants " + printable(wanted.view().substr(0, max_text_size)) +
                           ", this is " + config.application_uri,
                       "Part 4, 5.7.2.2 and 5.7.2.3", "Let the client connect to that server"});
    }
    return {};
}

Checked<void> check(const SessionNeeds& needs, const ServiceContext& context,
                    const CreateSessionRequest& request)
{
    const channel::ServerChannel& channel = context.peer.channel();
    const bool is_secure = !channel.security().policy->is_none();
    return check_endpoint(needs.config, channel.security())
        .and_then([&] { return check_server_uri(needs.config, request.server_uri); })
        .and_then([&] { return check_nonce(request.client_nonce, is_secure); })
        .and_then(
            [&] { return is_secure ? check_certificate(channel, request) : Checked<void>{}; });
}

Unexpected<Refusal> refuse_place(std::size_t count, std::string_view which)
{
    return refuse({status::Bad_TooManySessions, "place for a session",
                   std::to_string(count) + " " + std::string{which} + ", which is the limit",
                   "Part 4, 5.7.2", "Close sessions that are not needed, or raise the limit"});
}

/// Part 4, 5.7.2.1: sessions that are never activated must not keep others out.
Checked<void> make_place(const SessionNeeds& needs, const ServiceContext& context)
{
    const std::size_t over_channel = context.peer.sessions().size();
    if (over_channel >= needs.limits().max_sessions_per_channel) {
        return refuse_place(over_channel, "sessions over this channel");
    }
    if (!make_session_place(needs, context.peer.address())) {
        return refuse_place(needs.sessions.size(), "sessions, all activated");
    }
    return {};
}

/// Limits any number, including NaN, to the range.
std::chrono::milliseconds revise_timeout(const ServerLimits& limits, double requested_ms)
{
    const auto least = limits.min_session_timeout;
    const auto most = limits.max_session_timeout;
    if (!(requested_ms > static_cast<double>(least.count()))) {
        return least;
    }
    if (requested_ms >= static_cast<double>(most.count())) {
        return most;
    }
    return std::chrono::milliseconds{static_cast<std::int64_t>(requested_ms)};
}

Result<Guid> random_guid(crypto::Random& random)
{
    const auto bytes = random_bytes(random, 16);
    if (!bytes) {
        return fail(bytes.error());
    }
    return binary::from_bytes<Guid>(bytes->span());
}

/// Returns the part that is kept of a text before a login.
String shortened(const String& text)
{
    return String{std::string{busbar::detail::cut_short(text.view(), max_text_size)}};
}

/// The session's Object has it as BrowseName, which other clients see.
std::string session_name(std::string_view wanted, const Guid& id)
{
    const std::string_view name = busbar::detail::cut_short(wanted, max_text_size);
    if (name.find_first_not_of(' ') == std::string_view::npos) {
        return to_string(id);
    }
    return busbar::detail::is_name(name) ? std::string{name} : printable(name, max_text_size);
}

/// Returns the URL without the userinfo that it may have (RFC 3986, 3.2.1), since many clients see
/// it.
String without_userinfo(const String& url)
{
    const std::string_view text = url.view();
    const std::size_t scheme = text.find("://");
    const std::size_t begin = scheme == text.npos ? 0 : scheme + 3;
    const std::string_view authority =
        text.substr(begin, std::min(text.find_first_of("/?#", begin), text.size()) - begin);
    const std::size_t at = authority.rfind('@');
    return at == authority.npos
               ? url
               : String{std::string{text.substr(0, begin)}.append(text.substr(begin + at + 1))};
}

/// Stores the client's description for the diagnostics (Part 5, 12.11).
void describe_client(Session& session, const CreateSessionRequest& request)
{
    const ApplicationDescription& client = request.client_description;
    session.client_description.application_uri = shortened(client.application_uri);
    session.client_description.product_uri = shortened(client.product_uri);
    session.client_description.application_name = {shortened(client.application_name.locale),
                                                   shortened(client.application_name.text)};
    session.client_description.application_type = client.application_type;
    session.client_description.gateway_server_uri = shortened(client.gateway_server_uri);
    session.server_uri = shortened(request.server_uri);
    session.endpoint_url = shortened(without_userinfo(request.endpoint_url));
}

Result<std::unique_ptr<Session>> make_session(const SessionNeeds& needs,
                                              const ServiceContext& context,
                                              const CreateSessionRequest& request)
{
    crypto::Random& random = *needs.environment.random;
    const auto id = random_guid(random);
    const auto token = random_bytes(random, nonce_size);
    auto nonce = random_bytes(random, nonce_size);
    if (!id || !token || !nonce) {
        return fail(status::Bad_ResourceUnavailable);
    }
    const std::uint64_t sessionless = sessionless_requests * needs.limits().max_sessionless_message;
    auto session = std::make_unique<Session>(needs.limits().max_session_memory, sessionless);
    session->id = NodeId{needs.own_namespace, *id};
    session->authentication_token = NodeId{0, *token};
    session->server_nonce = *std::move(nonce);
    session->name = session_name(request.session_name.view(), *id);
    session->client_application_uri =
        request.client_description.application_uri.view().substr(0, max_text_size);
    describe_client(*session, request);
    session->address = context.peer.address();
    session->security = context.peer.channel().security();
    if (const auto& certificates = context.peer.channel().peer_certificates();
        !certificates.empty()) {
        session->client_certificate = {certificates.front()};
    }
    session->max_response_message_size = request.max_response_message_size;
    session->timeout = revise_timeout(needs.limits(), request.requested_session_timeout);
    session->created = context.now;
    session->connection_time = needs.wall_time();
    session->deadline = context.now + std::min(session->timeout, needs.limits().activation_timeout);
    return session;
}

void tell_refused(const ServiceContext& context, const CreateSessionRequest& request,
                  const Refusal& refusal)
{
    Record record{RecordKind::SessionRefused, LogLevel::Warning, "session"};
    record.status = refusal.status;
    record.refusal = &refusal;
    record.actor.session_name = request.session_name.view();
    record.actor.application_uri = request.client_description.application_uri.view();
    record.actor.audit_entry_id = context.mark.audit_entry_id;
    record.actor.action_time = context.mark.timestamp;
    record.actor.secure_channel_id = context.peer.channel().channel_id();
    if (const auto& peer = context.peer.channel().peer_certificates(); !peer.empty()) {
        record.certificate = peer.front().der();
    }
    tell(context.peer.log(), record);
}

void tell_created(const SessionNeeds& needs, const Session& session, const ServiceContext& context)
{
    const std::array fields{
        RecordField{"RevisedSessionTimeout", Variant{static_cast<double>(session.timeout.count())}},
        RecordField{"EndpointUrl", Variant{session.endpoint_url}}};
    Record record{RecordKind::SessionCreated, LogLevel::Info, "session"};
    record.text =
        "\"" + printable(session.name) + "\" created from " + std::string{context.peer.address()};
    record.actor = actor_of(session, context.mark);
    record.certificate = certificate_of(session);
    record.fields = fields;
    tell(needs.log, record);
}

/// Part 4, 5.7.2.2: a name that the server's certificate does not have may be an attacker's.
void tell_other_url(const SessionNeeds& needs, const Session& session,
                    const ServiceContext& context)
{
    const auto url = channel::EndpointUrl::parse(session.endpoint_url.view());
    if (!needs.log.wants(RecordKind::UrlMismatch) || !needs.config.identity ||
        session.endpoint_url.empty() ||
        (url && crypto::names_host(needs.config.identity->certificates.front(), url->host))) {
        return;
    }
    const std::array fields{RecordField{"EndpointUrl", Variant{session.endpoint_url}}};
    Record record{RecordKind::UrlMismatch, LogLevel::Debug, "session"};
    record.actor = actor_of(session, context.mark);
    record.certificate = certificate_of(session);
    record.fields = fields;
    needs.log.record(record);
}

} // namespace

StatusCode create_session(const SessionNeeds& needs, ServiceContext& context,
                          const CreateSessionRequest& request, CreateSessionResponse& response)
{
    const bool is_secure = !context.peer.channel().security().policy->is_none();
    const auto admitted = check(needs, context, request)
                              .and_then([&] {
                                  return is_secure ? use_nonce(needs.sessions, request.client_nonce)
                                                   : Checked<void>{};
                              })
                              .and_then([&] { return make_place(needs, context); });
    if (!admitted) {
        tell_refused(context, request, admitted.error());
        return admitted.error().status;
    }
    const auto& peer = context.peer.channel().peer_certificates();
    auto signature =
        sign_for_client(needs.config.identity ? &*needs.config.identity : nullptr,
                        context.peer.channel().security(),
                        peer.empty() ? std::span<const std::byte>{} : peer.front().der(),
                        request.client_nonce.span());
    if (!signature) {
        return signature.error();
    }
    auto made = make_session(needs, context, request);
    if (!made) {
        return made.error();
    }
    response.session_id = (*made)->id;
    response.authentication_token = (*made)->authentication_token;
    response.revised_session_timeout = static_cast<double>((*made)->timeout.count());
    response.server_nonce = (*made)->server_nonce;
    response.server_certificate = server_certificates(needs);
    response.server_endpoints = describe_endpoints(needs, request.endpoint_url.view());
    response.server_signature = *std::move(signature);
    response.max_request_message_size = needs.limits().transport.max_message_size;
    Session& session = needs.sessions.add(*std::move(made));
    busbar::detail::Undo undo{[&] { needs.sessions.remove(session); }};
    context.peer.bind(session);
    undo.keep();
    ++needs.counters.summary.cumulated_session_count;
    busbar::detail::attempt([&] { tell_created(needs, session, context); });
    busbar::detail::attempt([&] { tell_other_url(needs, session, context); });
    return status::Good;
}

} // namespace busbar::server::detail

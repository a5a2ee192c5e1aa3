#include <algorithm>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/channel/server_certificate.hpp>
#include <busbar/client/config_check.hpp>
#include <busbar/core/text.hpp>

#include "client_impl.hpp"
#include "deadline_heap.hpp"
#include "endpoint_filter.hpp"

namespace busbar::client {

namespace {

/// Maximum number of attempts to get a second connection, which the server may refuse while it
/// still counts the first one, and the delay before the first attempt; each further one is twice as
/// long.
constexpr std::uint32_t max_redials = 3;
constexpr Duration first_redial_wait = std::chrono::milliseconds{500};

/// Treats URLs as equal that differ only in a trailing slash.
bool is_same_url(std::string_view a, std::string_view b)
{
    const auto path = [](const channel::EndpointUrl& url) {
        return url.path == "/" ? std::string_view{} : std::string_view{url.path};
    };
    const auto left = channel::EndpointUrl::parse(a);
    const auto right = channel::EndpointUrl::parse(b);
    return left && right && channel::is_same_host(left->host, right->host) &&
           left->port == right->port && path(*left) == path(*right);
}

} // namespace

/// The states of Part 4, 6.7: an attempt waits for its time, gets a transport, requests endpoints
/// if necessary, and opens channel and session, over another transport if it needs security.
bool Client::Impl::advance()
{
    if (state == ClientState::Closing) {
        if (transport.is_none()) {
            connection.reset();
            set_state(ClientState::Closed, last_error);
            return true;
        }
        return false;
    }
    if (transport.lost() && is_drained) {
        lose(*transport.lost());
        return true;
    }
    if (now >= attempt_ends_at) {
        lose(status::Bad_Timeout);
        return true;
    }
    if (state == ClientState::Ready && now >= keep_alive.next_deadline()) {
        keep_alive_due();
        return true;
    }
    return transport.is_none() && go_on();
}

/// Called without a transport.
bool Client::Impl::go_on()
{
    if (state == ClientState::Discovering) {
        open_transport();
        return true;
    }
    if (state == ClientState::Waiting && is_wanted && now >= retry_at) {
        begin_attempt();
        return true;
    }
    if (state == ClientState::Connecting && now >= redial_at) {
        open_transport();
        return true;
    }
    return false;
}

void Client::Impl::begin_attempt()
{
    is_choice_old = choice.has_value();
    redials = 0;
    attempt_ends_at = detail::deadline_after(now, config.connect_timeout);
    if (const auto checked = check_config(config, environment); !checked) {
        environment.log->write(LogLevel::Error, "client", text(checked.error()));
        return lose(checked.error().status);
    }
    if (kept_session && now >= kept_session->ends_at) {
        kept_session.reset();
    }
    open_transport();
}

void Client::Impl::open_transport()
{
    connection.reset();
    if (config.is_reverse) {
        attempt_ends_at = no_deadline; // the time of the server's call is unknown
    }
    is_drained = true; // the rest of the previous connection is ignored
    transport.open(choice ? choice->endpoint.endpoint_url.str() : config.endpoint_url);
    set_state(ClientState::Connecting, {});
}

/// Endpoints are requested on a channel without any security.
bool Client::Impl::is_discovering() const
{
    return !choice &&
           (config.wants_session || config.asks_for_endpoints || !config.security.allows_none);
}

ConnectionConfig Client::Impl::connection_config() const
{
    ConnectionConfig to;
    to.channel.limits = config.transport;
    to.channel.endpoint_url = config.endpoint_url;
    to.channel.is_reverse = config.is_reverse;
    to.channel.expected_server_uri = config.server_uri;
    to.channel.requested_lifetime =
        std::chrono::duration_cast<std::chrono::milliseconds>(config.channel_lifetime);
    to.application_name = config.application_name;
    to.application_uri = config.application_uri;
    to.session_name = config.session_name;
    to.identity = config.identity;
    to.session_timeout =
        std::chrono::duration_cast<std::chrono::milliseconds>(config.session_timeout);
    to.locale_ids = config.locale_ids;
    to.request_timeout =
        std::chrono::duration_cast<std::chrono::milliseconds>(config.request_timeout);
    to.limits = config.decode;
    to.wants_session = false;
    if (!choice) {
        return to;
    }
    const EndpointDescription& endpoint = choice->endpoint;
    to.wants_session = config.wants_session;
    to.channel.endpoint_url = endpoint.endpoint_url.str();
    to.channel.security = {choice->policy, endpoint.security_mode};
    if (const auto chain = crypto::parse_chain(endpoint.server_certificate.span())) {
        to.channel.server_certificate = chain->front();
    }
    // The certificate names the application of the endpoint (Part 4, 6.1.3).
    if (to.channel.expected_server_uri.empty()) {
        to.channel.expected_server_uri = endpoint.server.application_uri.str();
    }
    to.token_policy = choice->token_policy;
    to.discovered_endpoints = discovered;
    if (kept_session && kept_session->security == to.channel.security &&
        kept_session->server_uri == endpoint.server.application_uri.view()) {
        to.resumed_session = kept_session->ticket;
    }
    return to;
}

void Client::Impl::use_connection()
{
    if (config.is_reverse) {
        attempt_ends_at = detail::deadline_after(now, config.connect_timeout);
    }
    connection.emplace(connection_config(), environment, now);
    set_state(is_discovering() ? ClientState::Discovering : ClientState::Opening, {});
}

/// The channel checks the certificate again when it is opened. At this point nothing has been
/// encrypted for the server yet, and the user learns of a wrong server even if the server does not
/// know this client (Part 4, 6.1.3).
Checked<void> Client::Impl::check_certificate(const EndpointChoice& chosen) const
{
    if (chosen.policy->is_none() || environment.validator == nullptr) {
        return {};
    }
    const EndpointDescription& endpoint = chosen.endpoint;
    const auto chain = crypto::parse_chain(endpoint.server_certificate.span());
    if (!chain) {
        return refuse({status::Bad_CertificateInvalid,
                       "server certificate",
                       "the endpoint shows none that can be read",
                       "Part 4, 7.14",
                       {}});
    }
    return channel::validate_server(environment, *chain, *chosen.policy,
                                    endpoint.server.application_uri.view(),
                                    endpoint.endpoint_url.view());
}

void Client::Impl::choose(const Array<EndpointDescription>& offered)
{
    auto chosen = detail::choose_endpoint(offered, config.security,
                                          config.wants_session ? &config.identity : nullptr,
                                          connection->endpoint_url(), *environment.log);
    if (!chosen) {
        return lose(chosen.error());
    }
    const String& uri = chosen->endpoint.server.application_uri;
    if (!config.server_uri.empty() && uri.view() != config.server_uri) {
        environment.log->write(LogLevel::Error, "client",
                               "this is " + printable(uri.view()) + " and not " +
                                   config.server_uri);
        return lose(status::Bad_ServerUriInvalid);
    }
    if (kept_session && kept_session->server_uri != uri.view()) {
        environment.log->write(LogLevel::Warning, "client",
                               "another server answers: " + printable(uri.view()));
    }
    if (const auto trusted = check_certificate(*chosen); !trusted) {
        explain(*environment.log, "client", trusted.error());
        return lose(trusted.error().status);
    }
    discovered = offered;
    choice = *std::move(chosen);
    is_detour = false;
    if (is_channel_chosen()) {
        set_state(ClientState::Opening, {});
        if (const auto opened = connection->open_session(connection_config()); !opened) {
            lose(opened.error());
        }
        return;
    }
    // advance() continues when it is closed.
    connection->close();
    transport.drop_with_peer(now, config.peer_close_timeout);
}

/// Returns whether the channel over which endpoints were requested is the chosen one: a server with
/// one connection (Part 7, Nano Embedded Device Server Profile) need not free it first.
bool Client::Impl::is_channel_chosen() const
{
    return choice->policy->is_none() && config.wants_session &&
           is_same_url(choice->endpoint.endpoint_url.view(), connection->endpoint_url());
}

/// The server was reached a moment ago, so the connection that it lacks may be the one that we
/// closed.
bool Client::Impl::may_dial_again(StatusCode why) const
{
    return state == ClientState::Opening && !is_choice_old && !config.is_reverse &&
           redials < max_redials && detail::is_server_full(why);
}

void Client::Impl::dial_again(StatusCode why)
{
    const Duration wait = first_redial_wait * (1U << redials++);
    redial_at = detail::deadline_after(now, wait);
    environment.log->write(
        LogLevel::Info, "client",
        "the server has not opened a second connection yet (" + std::string{name(why)} +
            "); again in " +
            std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(wait).count()) +
            " ms");
    drop_connection(false);
    set_state(ClientState::Connecting, {});
}

/// Behind a port map or a tunnel the URL of the endpoint leads nowhere, or to something else, while
/// the one that the endpoints came from has answered (Part 4, 5.5.4.1).
bool Client::Impl::may_go_where_reached(StatusCode why) const
{
    // What is no OPC UA server closes, is silent or says something else.
    const bool is_stranger = state == ClientState::Opening && !is_choice_old &&
                             (why == status::Bad_ConnectionClosed || why == status::Bad_Timeout ||
                              why == status::Bad_TcpMessageTypeInvalid);
    return (state == ClientState::Connecting || is_stranger) && choice && !config.is_reverse &&
           detail::final_reason(why).empty() && !choice->reached_by.empty() &&
           !is_same_url(choice->endpoint.endpoint_url.view(), choice->reached_by);
}

void Client::Impl::go_where_reached(StatusCode why)
{
    environment.log->write(LogLevel::Warning, "client",
                           "the server's URL " + printable(choice->endpoint.endpoint_url.view()) +
                               " does not answer (" + std::string{name(why)} + "); going on with " +
                               choice->reached_by + ", which it was reached by");
    drop_connection(false);
    choice->endpoint.endpoint_url = String{choice->reached_by};
    is_detour = true;
    attempt_ends_at = detail::deadline_after(now, config.connect_timeout);
    redial_at = now;
    set_state(ClientState::Connecting, {});
}

void Client::Impl::drop_connection(bool keeps_session)
{
    if (connection && keeps_session) {
        connection->leave();
    } else if (connection) {
        connection->close(deletes_subscriptions);
    }
    transport.drop(now);
    endpoints_handle = info_handle = state_handle = 0;
    for (PendingUserChange& change : user_changes) {
        if (!change.result) {
            change.handle = 0;
            change.result = status::Bad_ConnectionClosed;
        }
    }
    keep_alive.stop();
}

void Client::Impl::end_session()
{
    if (std::exchange(is_session_told, false)) {
        subscriptions.session_lost();
    }
}

/// Keeps the session for the next connection, which needs the same security (Part 4, 5.7.3.1).
void Client::Impl::keep_session()
{
    const SessionTicket& ticket = connection->session();
    kept_session = KeptSession{ticket,
                               {choice->policy, choice->endpoint.security_mode},
                               choice->endpoint.server.application_uri.str(),
                               detail::deadline_after(now, ticket.timeout)};
}

void Client::Impl::lose(StatusCode why)
{
    if (may_dial_again(why)) {
        return dial_again(why);
    }
    if (may_go_where_reached(why)) {
        return go_where_reached(why);
    }
    const bool had_session = state == ClientState::Ready && config.wants_session;
    const bool was_opening = state == ClientState::Opening;
    // An Error message proves nothing about a policy that the endpoints offer, or that every server
    // has for GetEndpoints: a party in between may have changed the answer.
    const bool is_policy_disputed =
        connection && connection->is_closed() &&
        (why == status::Bad_SecurityPolicyRejected || why == status::Bad_SecurityModeRejected);
    // What answers there may be a discovery server, while the one that is meant is away.
    const bool is_elsewhere = is_detour && was_opening;
    const bool is_choice_doubtful =
        (is_choice_old && was_opening) || is_elsewhere || is_policy_disputed;
    // A choice that worked for a session, or was not even tried, may work for the next one.
    const bool keeps_choice =
        state == ClientState::Ready || (is_choice_old && state == ClientState::Connecting);
    if (state == ClientState::Ready && now - ready_since >= config.reconnect.longest) {
        back_off.reset();
    }
    if (had_session) {
        keep_session();
    } else if (kept_session && was_opening && ++kept_session->failures == 2) {
        kept_session.reset(); // resuming it may be what makes the server fail
    }
    drop_connection(had_session || (connection && connection->is_resumed()));
    attempt_ends_at = no_deadline;
    requests.end(status::Bad_ConnectionClosed, false);
    end_session();
    if (!keeps_choice) {
        choice.reset();
    }
    failures_in_row += had_session ? 0 : 1;
    if (had_session || may_retry(why, is_choice_doubtful)) {
        retry_later(why);
    } else {
        begin_closing(why);
    }
}

/// A failure with an old choice is not final: the server may have another certificate or other
/// endpoints now.
bool Client::Impl::may_retry(StatusCode why, bool is_choice_doubtful) const
{
    return is_choice_doubtful || detail::final_reason(why).empty();
}

void Client::Impl::retry_later(StatusCode why)
{
    last_error = why;
    const ReconnectPolicy& policy = config.reconnect;
    if (!policy.is_enabled ||
        (policy.max_attempts != 0 && failures_in_row >= policy.max_attempts)) {
        begin_closing(why);
        return;
    }
    const Duration wait = back_off.next(*environment.random);
    retry_at = detail::deadline_after(now, wait);
    environment.log->write(
        LogLevel::Warning, "client",
        "no connection: " + text_of_loss(why) + "; next attempt in " +
            std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(wait).count()) +
            " ms");
    set_state(ClientState::Waiting, why);
}

/// "Connection refused (Bad_CommunicationError)".
std::string Client::Impl::text_of_loss(StatusCode why) const
{
    const std::string status{name(why)};
    return transport.reason().empty() ? status : transport.reason() + " (" + status + ")";
}

void Client::Impl::begin_closing(StatusCode why)
{
    const std::string_view reason = detail::final_reason(why);
    // Without reconnection a caller may make several attempts: the end of one is not worth
    // reporting.
    if (why.is_bad() && (config.reconnect.is_enabled || !reason.empty())) {
        environment.log->write(LogLevel::Error, "client",
                               "giving up: " + text_of_loss(why) + " " + std::string{reason});
    }
    is_wanted = false;
    kept_session.reset();
    drop_connection(false);
    attempt_ends_at = no_deadline;
    end_session();
    last_error = why;
    requests.end(why.is_bad() ? status::Bad_ServerNotConnected : status::Bad_ConnectionClosed,
                 true);
    set_state(ClientState::Closing, why);
}

} // namespace busbar::client

#include <algorithm>

#include <busbar/core/text.hpp>

#include "client_impl.hpp"
#include "endpoint_filter.hpp"
#include "pending_requests.hpp"

namespace busbar::client {

/// The states of Part 4, 6.7: an attempt waits for its time, gets a transport, asks for endpoints
/// over a first one if it has to, and opens channel and session over the next.
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
    if (transport.lost()) {
        lose(*transport.lost());
        return true;
    }
    if (now >= attempt_ends_at) {
        lose(status::Bad_Timeout);
        return true;
    }
    if (!transport.is_none()) {
        if (state == ClientState::Ready && now >= keep_alive.next_deadline()) {
            keep_alive_due();
            return true;
        }
        return false;
    }
    if (state == ClientState::Discovering) { // the first transport is gone
        open_transport();
        return true;
    }
    if (state == ClientState::Waiting && is_wanted && now >= retry_at) {
        begin_attempt();
        return true;
    }
    return false;
}

void Client::Impl::begin_attempt()
{
    is_choice_old = choice.has_value();
    // Nobody knows when the server will call.
    attempt_ends_at =
        config.is_reverse ? no_deadline : detail::deadline_after(now, config.connect_timeout);
    if (ticket && now >= ticket_ends_at) {
        ticket.reset();
    }
    open_transport();
}

void Client::Impl::open_transport()
{
    connection.reset();
    transport.open(choice ? choice->endpoint.endpoint_url.str() : config.endpoint_url);
    set_state(ClientState::Connecting, {});
}

/// Endpoints are asked for on a connection of their own, whose security is that of a postcard.
bool Client::Impl::is_discovering() const
{
    return !choice && (config.wants_session || !config.security.allows_none);
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
    // The certificate names the application that the endpoint is of (Part 4, 6.1.3).
    if (to.channel.expected_server_uri.empty()) {
        to.channel.expected_server_uri = endpoint.server.application_uri.str();
    }
    to.token_policy = choice->token_policy;
    to.discovered_endpoints = discovered;
    to.resumed_session = ticket;
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
    discovered = offered;
    choice = *std::move(chosen);
    drop_connection(); // advance() goes on when it is gone
}

void Client::Impl::drop_connection()
{
    if (connection) {
        connection->leave();
    }
    transport.drop(now);
    endpoints_handle = info_handle = state_handle = 0;
    keep_alive.stop();
}

void Client::Impl::lose(StatusCode why)
{
    const bool was_ready = state == ClientState::Ready;
    if (was_ready && config.wants_session) {
        ticket = connection->session();
        ticket_ends_at = detail::deadline_after(now, ticket->timeout);
    }
    drop_connection();
    attempt_ends_at = no_deadline;
    requests.end(status::Bad_ConnectionClosed, false);
    if (was_ready && config.wants_session) {
        subscriptions.session_lost();
    }
    retry_later(why);
}

void Client::Impl::retry_later(StatusCode why)
{
    last_error = why;
    ++failures_in_row;
    const ReconnectPolicy& policy = config.reconnect;
    const bool is_last = policy.max_attempts != 0 && failures_in_row >= policy.max_attempts;
    const std::string_view reason = detail::final_reason(why);
    choice.reset();
    if (!policy.is_enabled || is_last || !reason.empty()) {
        begin_closing(why);
        return;
    }
    retry_at = now + back_off.next(*environment.random);
    set_state(ClientState::Waiting, why);
}

void Client::Impl::begin_closing(StatusCode why)
{
    is_wanted = false;
    attempt_ends_at = no_deadline;
    if (state == ClientState::Ready && connection) {
        if (config.wants_session) {
            subscriptions.session_lost();
        }
        connection->close(deletes_subscriptions);
    }
    ticket.reset();
    drop_connection();
    last_error = why;
    requests.end(why.is_bad() ? status::Bad_ServerNotConnected : status::Bad_ConnectionClosed,
                 true);
    set_state(ClientState::Closing, why);
}

} // namespace busbar::client

#include <algorithm>

#include <busbar/core/text.hpp>

#include "client_impl.hpp"
#include "user_token.hpp"

namespace busbar::client {

bool Client::Impl::receive()
{
    is_drained = true;
    if (!connection || transport.state() != detail::Transport::State::Up) {
        return false;
    }
    connection->handle_deadline(now); // also sets the time of requests that are sent next
    auto event = connection->next_event();
    is_drained = !event;
    if (!event) {
        return false;
    }
    handle(*std::move(event));
    return true;
}

void Client::Impl::handle(ConnectionEvent event)
{
    switch (event.kind) {
    case ConnectionEvent::Kind::Ready:
        connection_ready();
        break;
    case ConnectionEvent::Kind::Response:
        handle_response(std::move(event));
        break;
    case ConnectionEvent::Kind::Closed:
        lose(event.status.is_bad() ? event.status : StatusCode{status::Bad_ConnectionClosed});
        break;
    }
}

template <typename Request>
void Client::Impl::ask(Request request, std::uint32_t& handle, Duration timeout)
{
    const auto sent = connection->send(std::move(request), timeout);
    if (!sent) {
        lose(sent.error());
        return;
    }
    handle = *sent;
}

void Client::Impl::connection_ready()
{
    if (state == ClientState::Discovering) {
        GetEndpointsRequest request;
        request.endpoint_url = String{connection->endpoint_url()};
        ask(std::move(request), endpoints_handle);
    } else if (config.wants_session) {
        reader = detail::ServerInfoReader{config.max_server_names};
        ask(reader.request(), info_handle);
    } else {
        become_ready();
    }
}

void Client::Impl::handle_response(ConnectionEvent event)
{
    const auto is_for = [&](std::uint32_t& handle) {
        const bool is_it = handle != 0 && event.handle == handle;
        handle = is_it ? 0 : handle;
        return is_it;
    };
    if (is_for(endpoints_handle)) {
        return endpoints_arrived(event);
    }
    if (is_for(info_handle)) {
        return info_arrived(event);
    }
    const auto change =
        std::find_if(user_changes.begin(), user_changes.end(), [&](const PendingUserChange& one) {
            return one.handle != 0 && one.handle == event.handle;
        });
    if (change != user_changes.end()) {
        return user_change_arrived(*change, event.status);
    }
    if (is_for(state_handle)) {
        state_arrived(event);
    } else {
        requests.answer(event.context, event.status.is_bad()
                                           ? Result<ResponseBody>{fail(event.status)}
                                           : ResponseBody{std::move(event.body)});
    }
    if (config.wants_session && state == ClientState::Ready &&
        detail::is_session_gone(event.status)) {
        lose(event.status);
        kept_session.reset();
    }
}

void Client::Impl::endpoints_arrived(const ConnectionEvent& event)
{
    const auto response = event.response<GetEndpointsResponse>(config.decode);
    if (!response) {
        return lose(response.error());
    }
    choose(response->endpoints);
}

void Client::Impl::info_arrived(const ConnectionEvent& event)
{
    const auto is_done = reader.take(event.response<ReadResponse>(config.decode));
    if (!is_done) {
        return lose(is_done.error());
    }
    if (!*is_done) {
        return ask(reader.request(), info_handle);
    }
    const std::uint64_t revision = info.revision;
    const bool has_changed = revision == 0 || !detail::is_same(info, reader.info());
    info = reader.info();
    info.revision = revision + (has_changed ? 1 : 0);
    types = detail::types_at(info, config.types);
    become_ready();
}

void Client::Impl::become_ready()
{
    const bool is_resumed = connection->is_resumed();
    attempt_ends_at = no_deadline;
    ready_since = now;
    failures_in_row = 0;
    set_state(ClientState::Ready, {});
    if (!config.wants_session) {
        return;
    }
    kept_session.reset();
    keep_alive.start(
        now, std::min<Duration>(config.keep_alive_interval, connection->session().timeout / 3));
    is_session_told = true;
    subscriptions.session_started(is_resumed ? Subscriptions::SessionStart::Resumed
                                             : Subscriptions::SessionStart::New);
}

void Client::Impl::begin_user_change(PendingUserChange change)
{
    const auto answer = [&](StatusCode status) { change.result = status; };
    const bool is_other_under_way =
        std::any_of(user_changes.begin(), user_changes.end(),
                    [](const PendingUserChange& other) { return !other.result; });
    if (state == ClientState::Waiting || state == ClientState::Closed) {
        config.identity = std::move(change.identity);
        choice.reset();       // it was chosen for the previous user
        kept_session.reset(); // another channel can resume a session for its own user only
        answer(status::Good_CompletesAsynchronously);
    } else if (state != ClientState::Ready || !config.wants_session || is_other_under_way) {
        answer(status::Bad_InvalidState);
    } else if (const UserTokenPolicy* const policy = detail::find_token_policy(
                   choice->endpoint.user_identity_tokens,
                   {choice->policy, choice->endpoint.security_mode}, change.identity)) {
        change.token_policy = *policy;
        const auto sent = connection->change_user(change.identity, change.token_policy);
        if (sent) {
            change.handle = *sent;
        } else {
            answer(sent.error());
        }
    } else {
        answer(status::Bad_IdentityTokenRejected);
    }
    user_changes.push_back(std::move(change));
}

void Client::Impl::user_change_arrived(PendingUserChange& change, StatusCode status)
{
    change.handle = 0;
    change.result = status.is_bad() ? status : StatusCode{};
    if (!status.is_bad()) {
        config.identity = std::move(change.identity);
        choice->token_policy = std::move(change.token_policy);
    } else if (status == status::Bad_Timeout || status == status::Bad_NonceInvalid ||
               detail::is_session_gone(status)) {
        lose(status); // the user of the session is unknown now
    }
}

bool Client::Impl::tell_user_change()
{
    if (user_changes.empty() || !user_changes.front().result) {
        return false;
    }
    const PendingUserChange change = std::move(user_changes.front());
    user_changes.pop_front();
    if (change.done) {
        change.done(*change.result);
    }
    return true;
}

void Client::Impl::keep_alive_due()
{
    switch (keep_alive.due(now)) {
    case detail::KeepAlive::Action::None:
        break;
    case detail::KeepAlive::Action::Ask:
        if (state_handle != 0) {
            connection->forget(state_handle);
        }
        ask(detail::state_request(), state_handle, 2 * keep_alive.interval());
        break;
    case detail::KeepAlive::Action::GiveUp:
        lose(status::Bad_Timeout);
        break;
    }
}

void Client::Impl::state_arrived(const ConnectionEvent& event)
{
    const auto response = event.response<ReadResponse>(config.decode);
    const ServerState before = info.state;
    if (response && detail::take_state(*response, info) && info.state != before) {
        environment.log->write(
            info.state == ServerState::Running ? LogLevel::Info : LogLevel::Warning, "client",
            "the server is in State " + std::to_string(static_cast<std::int32_t>(info.state)) +
                ", and shuts down in " + std::to_string(info.seconds_till_shutdown) + " s");
    }
}

} // namespace busbar::client

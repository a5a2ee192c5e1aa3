#include <busbar/core/text.hpp>

#include "client_impl.hpp"

namespace busbar::client {

bool Client::Impl::receive()
{
    is_drained = true;
    if (!connection || transport.state() != detail::Transport::State::Up) {
        return false;
    }
    connection->handle_deadline(now); // which also tells the time of what is sent next
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

void Client::Impl::keep_alive_due()
{
    switch (keep_alive.due(now)) {
    case detail::KeepAlive::Action::None:
        break;
    case detail::KeepAlive::Action::Ask:
        if (state_handle != 0) {
            connection->cancel(state_handle);
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

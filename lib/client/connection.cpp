#include "connection_impl.hpp"

#include <algorithm>

namespace busbar::client {

namespace {

/// TimeoutHint counts whole milliseconds, and zero means none (Part 4, 7.33).
std::uint32_t timeout_hint(Duration timeout)
{
    const auto hint = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(hint, 1, UINT32_MAX));
}

} // namespace

Result<std::uint32_t>
Connection::Impl::send(FunctionRef<void(binary::Writer&, const RequestHeader&)> encode,
                       Duration timeout, std::uint64_t context)
{
    if (timeout <= Duration::zero()) {
        timeout = config.request_timeout;
    }
    RequestHeader header;
    header.authentication_token = session.ticket.authentication_token;
    header.timestamp = environment.wall_clock->now();
    header.request_handle = ++last_request_handle;
    header.timeout_hint = timeout_hint(timeout);
    const auto id = channel.send([&](binary::Writer& writer) { encode(writer, header); });
    if (id) {
        pending.add(*id, detail::deadline_after(now, timeout), context, header.request_handle);
    }
    return id;
}

template <typename Request>
Result<void> Connection::Impl::send(Request& request)
{
    const auto sent = send([&](binary::Writer& writer, const RequestHeader& header) {
        request.request_header = header;
        encode(writer, NodeId{0, Request::binary_encoding_id});
        encode(writer, request);
    });
    return sent ? Result<void>{} : fail(sent.error());
}

void Connection::Impl::handle(channel::ChannelEvent event)
{
    switch (event.kind) {
    case channel::ChannelEvent::Kind::Opened:
        handle_opened();
        break;
    case channel::ChannelEvent::Kind::Renewed:
        break;
    case channel::ChannelEvent::Kind::Message:
    case channel::ChannelEvent::Kind::Aborted:
        handle_response(std::move(event));
        break;
    case channel::ChannelEvent::Kind::Closed:
        end(event.status);
        break;
    }
}

void Connection::Impl::handle_opened()
{
    if (!config.wants_session) {
        become_ready();
    } else if (config.resumed_session) {
        session.ticket = *config.resumed_session;
        activate_session(State::Resuming);
    } else {
        create_session();
    }
}

void Connection::Impl::handle_response(channel::ChannelEvent event)
{
    const auto context = pending.remove(event.request_id);
    if (!context) {
        return; // it came too late, or was not requested
    }
    ConnectionEvent response{ConnectionEvent::Kind::Response, event.request_id, event.status,
                             std::move(event.body), *context};
    if (response.status.is_good()) {
        // Every response begins with its header, which is all that a ServiceFault has.
        binary::Reader reader{response.body};
        NodeId id;
        ResponseHeader header;
        decode(reader, id);
        decode(reader, header);
        response.status = reader.ok() ? header.service_result : status::Bad_DecodingError;
    }
    if (state == State::Creating) {
        session_created(response);
    } else if (state == State::Activating || state == State::Resuming) {
        session_activated(response);
    } else {
        if (user_change && user_change->handle == response.handle) {
            user_changed(response);
        }
        events.push_back(std::move(response));
    }
}

void Connection::Impl::create_session()
{
    session = {};
    auto request = detail::make_create_session(config, environment, session);
    const auto sent = request ? send(*request) : fail(request.error());
    state = State::Creating;
    if (!sent) {
        end(sent.error());
    }
}

void Connection::Impl::session_created(const ConnectionEvent& event)
{
    const auto response = event.response<CreateSessionResponse>(config.limits);
    if (!response) {
        end(response.error());
        return;
    }
    const auto accepted = detail::accept_session(config, environment, *response, session);
    if (!accepted) {
        abandon(accepted.error());
        return;
    }
    activate_session(State::Activating);
}

void Connection::Impl::activate_session(State next)
{
    auto request = detail::make_activate_session(config, environment, session);
    const auto sent = request ? send(*request) : fail(request.error());
    state = next;
    if (!sent && next == State::Resuming) {
        create_session();
    } else if (!sent) {
        abandon(sent.error());
    }
}

void Connection::Impl::session_activated(const ConnectionEvent& event)
{
    const auto response = event.response<ActivateSessionResponse>(config.limits);
    const auto accepted =
        response ? detail::accept_activation(config, *response, session) : fail(response.error());
    if (accepted) {
        is_resumed = state == State::Resuming;
        become_ready();
    } else if (state == State::Resuming) {
        // For any reason: the server has forgotten the session, or has created another nonce for an
        // activation whose answer was lost. If it is the user, the new session will tell.
        environment.log->write(LogLevel::Info, "client",
                               "the server does not resume the session: " +
                                   std::string{name(accepted.error())});
        create_session();
    } else {
        abandon(accepted.error());
    }
}

void Connection::Impl::become_ready()
{
    state = State::Ready;
    events.push_back({ConnectionEvent::Kind::Ready, 0, {}, {}, 0});
}

void Connection::Impl::close_session(bool deletes_subscriptions)
{
    CloseSessionRequest request;
    request.delete_subscriptions = deletes_subscriptions;
    static_cast<void>(send(request));
}

/// A session that is being resumed is not ours yet.
bool Connection::Impl::has_session() const
{
    return state != State::Resuming && state != State::Closed &&
           !session.ticket.authentication_token.is_null();
}

/// The answer is ignored.
void Connection::Impl::tell_cancelled(std::uint32_t request_handle)
{
    CancelRequest request;
    request.request_handle = request_handle;
    const auto sent = send([&](binary::Writer& writer, const RequestHeader& header) {
        request.request_header = header;
        encode(writer, NodeId{0, CancelRequest::binary_encoding_id});
        encode(writer, request);
    });
    if (sent) {
        pending.remove(*sent);
    }
}

Result<std::uint32_t> Connection::Impl::change_user(UserChange change)
{
    ConnectionConfig next = config;
    next.identity = change.identity;
    next.token_policy = change.token_policy;
    auto request = detail::make_activate_session(next, environment, session);
    if (!request) {
        return fail(request.error());
    }
    const auto sent = send([&](binary::Writer& writer, const RequestHeader& header) {
        request->request_header = header;
        encode(writer, NodeId{0, ActivateSessionRequest::binary_encoding_id});
        encode(writer, *request);
    });
    if (sent) {
        change.handle = *sent;
        user_change = std::move(change);
    }
    return sent;
}

/// A bad answer means that the session keeps its user; `event` reports it.
void Connection::Impl::user_changed(ConnectionEvent& event)
{
    UserChange change = *std::exchange(user_change, std::nullopt);
    const auto response = event.response<ActivateSessionResponse>(config.limits);
    const auto accepted =
        response ? detail::accept_activation(config, *response, session) : fail(response.error());
    if (accepted) {
        config.identity = std::move(change.identity);
        config.token_policy = std::move(change.token_policy);
    } else {
        event.status = accepted.error();
        event.body.clear();
    }
}

/// Prevents the server from keeping an unused session.
void Connection::Impl::abandon(StatusCode status)
{
    if (has_session()) {
        close_session(true);
    }
    end(status);
}

void Connection::Impl::end(StatusCode status)
{
    if (state == State::Closed) {
        return;
    }
    const auto ended = pending.take_all();
    state = State::Closed;
    for (const auto& [id, context] : ended) {
        events.push_back(
            {ConnectionEvent::Kind::Response, id, status::Bad_SecureChannelClosed, {}, context});
    }
    events.push_back({ConnectionEvent::Kind::Closed, 0, status, {}, 0});
    channel.close();
}

} // namespace busbar::client

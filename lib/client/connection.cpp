#include <busbar/client/connection.hpp>

#include <algorithm>
#include <deque>

#include "session.hpp"

namespace busbar::client {

namespace {

enum class State : std::uint8_t { Connecting, Creating, Activating, Ready, Closed };

struct Pending {
    std::uint32_t request_id{0};
    std::uint32_t handle{0};
    TimePoint deadline;
};

} // namespace

struct Connection::Impl {
    Impl(ConnectionConfig c, const channel::ChannelEnvironment& e, TimePoint start)
        : config{std::move(c)},
          environment{e}, channel{config.channel, environment, start}, now{start}
    {
    }

    void fill(RequestHeader& header);
    [[nodiscard]] Result<void> send(std::uint32_t handle,
                                    FunctionRef<void(binary::Writer&)> encode);
    template <typename Request>
    [[nodiscard]] Result<void> send(Request& request);
    void handle(channel::Event event);
    void handle_opened();
    void handle_response(channel::Event event);
    void create_session();
    void activate_session(const ConnectionEvent& event);
    void finish_activation(const ConnectionEvent& event);
    void end(StatusCode status);

    ConnectionConfig config;
    channel::ChannelEnvironment environment;
    channel::ClientChannel channel;
    detail::SessionData session;
    State state{State::Connecting};
    TimePoint now;
    std::uint32_t last_handle{0};
    std::deque<Pending> pending; // in the order of their deadlines
    std::deque<ConnectionEvent> events;
};

void Connection::Impl::fill(RequestHeader& header)
{
    header.authentication_token = session.authentication_token;
    header.timestamp = environment.wall_clock->now();
    header.request_handle = ++last_handle;
    header.timeout_hint = static_cast<std::uint32_t>(config.request_timeout.count());
}

Result<void> Connection::Impl::send(std::uint32_t handle, FunctionRef<void(binary::Writer&)> encode)
{
    const auto id = channel.send(encode);
    if (!id) {
        return fail(id.error());
    }
    pending.push_back({*id, handle, now + config.request_timeout});
    return {};
}

template <typename Request>
Result<void> Connection::Impl::send(Request& request)
{
    fill(request.request_header);
    return send(request.request_header.request_handle, [&](binary::Writer& writer) {
        encode(writer, NodeId{0, Request::binary_encoding_id});
        encode(writer, request);
    });
}

void Connection::Impl::handle(channel::Event event)
{
    switch (event.kind) {
    case channel::Event::Kind::Opened:
        handle_opened();
        break;
    case channel::Event::Kind::Renewed:
        break;
    case channel::Event::Kind::Message:
    case channel::Event::Kind::Aborted:
        handle_response(std::move(event));
        break;
    case channel::Event::Kind::Closed:
        end(event.status);
        break;
    }
}

void Connection::Impl::handle_opened()
{
    if (config.wants_session) {
        create_session();
    } else {
        state = State::Ready;
        events.push_back({ConnectionEvent::Kind::Ready, 0, {}, {}});
    }
}

void Connection::Impl::handle_response(channel::Event event)
{
    const auto found = std::find_if(pending.begin(), pending.end(), [&](const Pending& p) {
        return p.request_id == event.request_id;
    });
    if (found == pending.end()) {
        return; // it came too late
    }
    ConnectionEvent response{ConnectionEvent::Kind::Response, found->handle, event.status,
                             std::move(event.body)};
    pending.erase(found);
    if (response.status.is_good()) {
        // Every response begins with its header, a ServiceFault is nothing else.
        binary::Reader reader{response.body, binary::Strings::Borrow};
        NodeId id;
        ResponseHeader header;
        decode(reader, id);
        decode(reader, header);
        response.status = reader.ok() ? header.service_result : status::Bad_DecodingError;
    }
    if (state == State::Creating) {
        activate_session(response);
    } else if (state == State::Activating) {
        finish_activation(response);
    } else {
        events.push_back(std::move(response));
    }
}

void Connection::Impl::create_session()
{
    auto request = detail::make_create_session(config, environment, session);
    const auto sent = request ? send(*request) : fail(request.error());
    state = State::Creating;
    if (!sent) {
        end(sent.error());
    }
}

void Connection::Impl::activate_session(const ConnectionEvent& event)
{
    const auto response = event.response<CreateSessionResponse>(config.limits);
    if (!response) {
        end(response.error());
        return;
    }
    const auto accepted = detail::accept_session(config, *response, session);
    if (!accepted) {
        end(accepted.error());
        return;
    }
    auto request = detail::make_activate_session(config, environment, session);
    const auto sent = request ? send(*request) : fail(request.error());
    state = State::Activating;
    if (!sent) {
        end(sent.error());
    }
}

void Connection::Impl::finish_activation(const ConnectionEvent& event)
{
    const auto response = event.response<ActivateSessionResponse>(config.limits);
    if (!response) {
        end(response.error());
        return;
    }
    session.server_nonce = response->server_nonce;
    state = State::Ready;
    events.push_back({ConnectionEvent::Kind::Ready, 0, {}, {}});
}

void Connection::Impl::end(StatusCode status)
{
    if (std::exchange(state, State::Closed) == State::Closed) {
        return;
    }
    for (const Pending& request : std::exchange(pending, {})) {
        events.push_back(
            {ConnectionEvent::Kind::Response, request.handle, status::Bad_SecureChannelClosed, {}});
    }
    events.push_back({ConnectionEvent::Kind::Closed, 0, status, {}});
    channel.close();
}

Connection::Connection(ConnectionConfig config, const channel::ChannelEnvironment& environment,
                       TimePoint now)
    : impl_{std::make_unique<Impl>(std::move(config), environment, now)}
{
}
Connection::Connection(Connection&&) noexcept = default;
Connection& Connection::operator=(Connection&&) noexcept = default;
Connection::~Connection() = default;

Result<void> Connection::feed(std::span<const std::byte> in, TimePoint now)
{
    impl_->now = now;
    return impl_->channel.feed(in, now);
}

std::optional<ConnectionEvent> Connection::next_event()
{
    while (impl_->events.empty()) {
        auto event = impl_->channel.next_event();
        if (!event) {
            return std::nullopt;
        }
        impl_->handle(*std::move(event));
    }
    ConnectionEvent event = std::move(impl_->events.front());
    impl_->events.pop_front();
    return event;
}

std::span<const std::byte> Connection::output() const
{
    return impl_->channel.output();
}

void Connection::consume(std::size_t size)
{
    impl_->channel.consume(size);
}

TimePoint Connection::next_deadline() const
{
    const TimePoint channel = impl_->channel.next_deadline();
    return impl_->pending.empty() ? channel : std::min(channel, impl_->pending.front().deadline);
}

void Connection::handle_deadline(TimePoint now)
{
    impl_->now = now;
    while (!impl_->pending.empty() && impl_->pending.front().deadline <= now) {
        const std::uint32_t handle = impl_->pending.front().handle;
        impl_->pending.pop_front();
        if (impl_->state != State::Ready) {
            impl_->end(status::Bad_Timeout);
            return;
        }
        impl_->events.push_back({ConnectionEvent::Kind::Response, handle, status::Bad_Timeout, {}});
    }
    impl_->channel.handle_deadline(now);
}

bool Connection::is_closed() const
{
    return impl_->channel.is_closed();
}

void Connection::close()
{
    if (impl_->state == State::Ready && impl_->config.wants_session) {
        CloseSessionRequest request;
        request.delete_subscriptions = true;
        static_cast<void>(impl_->send(request));
    }
    impl_->end({});
}

const Array<EndpointDescription>& Connection::endpoints() const
{
    return impl_->session.endpoints;
}

void Connection::fill(RequestHeader& header)
{
    impl_->fill(header);
}

Result<void> Connection::send(std::uint32_t handle, FunctionRef<void(binary::Writer&)> encode)
{
    if (impl_->state != State::Ready) {
        return fail(status::Bad_SessionNotActivated);
    }
    return impl_->send(handle, encode);
}

} // namespace busbar::client

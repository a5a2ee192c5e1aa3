#include "connection_impl.hpp"

#include <algorithm>
#include <utility>

namespace busbar::client {

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
    return std::min(impl_->channel.next_deadline(), impl_->pending.next_deadline());
}

void Connection::handle_deadline(TimePoint now)
{
    impl_->now = now;
    while (const auto expired = impl_->pending.take_expired(now)) {
        if (impl_->state != detail::ConnectionState::Ready) {
            impl_->abandon(status::Bad_Timeout);
            return;
        }
        impl_->events.push_back({ConnectionEvent::Kind::Response,
                                 expired->id,
                                 status::Bad_Timeout,
                                 {},
                                 expired->context});
    }
    impl_->channel.handle_deadline(now);
}

bool Connection::is_closed() const
{
    return impl_->channel.is_closed();
}

Result<std::uint32_t>
Connection::send_encoded(FunctionRef<void(binary::Writer&, const RequestHeader&)> encode,
                         Duration timeout, std::uint64_t context)
{
    if (impl_->state != detail::ConnectionState::Ready) {
        return fail(status::Bad_SessionNotActivated);
    }
    return impl_->send(encode, timeout, context);
}

Result<void> Connection::open_session(ConnectionConfig config)
{
    if (impl_->state != detail::ConnectionState::Ready || impl_->config.wants_session) {
        return fail(status::Bad_InvalidState);
    }
    impl_->config = std::move(config);
    impl_->handle_opened();
    return {};
}

void Connection::cancel(std::uint32_t handle)
{
    const std::uint32_t request_handle = impl_->pending.handle_of(handle);
    forget(handle);
    if (request_handle != 0 && impl_->state == detail::ConnectionState::Ready &&
        impl_->has_session()) {
        impl_->tell_cancelled(request_handle);
    }
}

Result<std::uint32_t> Connection::change_user(UserIdentity identity,
                                              std::optional<UserTokenPolicy> token_policy)
{
    if (impl_->state != detail::ConnectionState::Ready || !impl_->has_session() ||
        impl_->user_change) {
        return fail(status::Bad_InvalidState);
    }
    return impl_->change_user({0, std::move(identity), std::move(token_policy)});
}

void Connection::forget(std::uint32_t handle)
{
    if (impl_->user_change && impl_->user_change->handle == handle) {
        impl_->user_change.reset();
    }
    if (impl_->pending.remove(handle)) {
        return;
    }
    std::erase_if(impl_->events, [&](const ConnectionEvent& event) {
        return event.kind == ConnectionEvent::Kind::Response && event.handle == handle;
    });
}

void Connection::close(bool deletes_subscriptions)
{
    if (impl_->has_session()) {
        impl_->close_session(deletes_subscriptions);
    }
    impl_->end({});
}

void Connection::leave()
{
    impl_->end({});
}

const Array<EndpointDescription>& Connection::endpoints() const
{
    return impl_->session.endpoints;
}

const SessionTicket& Connection::session() const
{
    return impl_->session.ticket;
}

bool Connection::is_resumed() const
{
    return impl_->is_resumed;
}

const std::string& Connection::endpoint_url() const
{
    return impl_->channel.endpoint_url();
}

} // namespace busbar::client

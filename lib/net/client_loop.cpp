#include <busbar/net/client_loop.hpp>

#include <algorithm>

#include <asio/connect.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>

#include <busbar/channel/endpoint_url.hpp>

#include "link.hpp"
#include "memory_return.hpp"
#include "name_lookup.hpp"

namespace busbar::net {

struct ClientLoop::Impl {
    using ClientLink = detail::SocketLink<client::Connection>;

    asio::io_context context;
    std::optional<client::Connection> client;
    std::shared_ptr<ClientLink> link;
    bool is_connected{false};
    detail::MemoryReturn memory_return;

    /// Lets the link work until there is an event or the time is over.
    [[nodiscard]] std::optional<client::ConnectionEvent> wait(TimePoint until);
};

ClientLoop::ClientLoop() : impl_{std::make_unique<Impl>()}
{
    detail::keep_free_memory(); // memory_return returns it
}

ClientLoop::~ClientLoop()
{
    if (impl_->link) {
        impl_->link->end();
    }
}

Result<void> ClientLoop::connect(client::ConnectionConfig config,
                                 const channel::ChannelEnvironment& environment, Duration timeout)
{
    const auto endpoint = channel::EndpointUrl::parse(config.channel.endpoint_url);
    if (!endpoint) {
        return fail(endpoint.error());
    }
    std::vector<asio::ip::tcp::endpoint> addresses;
    for (const asio::ip::address& address : detail::system_lookup(endpoint->host)) {
        addresses.emplace_back(address, endpoint->port);
    }
    if (addresses.empty()) {
        return fail(status::Bad_CommunicationError);
    }
    asio::ip::tcp::socket socket{impl_->context};
    std::error_code error = asio::error::would_block;
    asio::async_connect(
        socket, addresses,
        [&](std::error_code result, const asio::ip::tcp::endpoint&) { error = result; });
    impl_->context.restart();
    const TimePoint until = detail::now() + timeout;
    while (error == asio::error::would_block && impl_->context.run_one_until(until) != 0) {
    }
    if (error) {
        const bool is_late = error == asio::error::would_block;
        socket.close(error);
        impl_->context.restart();
        impl_->context.poll();
        return fail(is_late ? status::Bad_Timeout : status::Bad_CommunicationError);
    }
    impl_->client.emplace(std::move(config), environment, detail::now());
    impl_->is_connected = true;
    impl_->link = std::make_shared<Impl::ClientLink>(
        std::move(socket), *impl_->client,
        [this](auto&) { impl_->memory_return.note_activity(detail::now()); },
        [this](auto&) { impl_->is_connected = false; });
    impl_->link->start();
    return {};
}

client::Connection& ClientLoop::client()
{
    return *impl_->client;
}

std::optional<client::ConnectionEvent> ClientLoop::Impl::wait(TimePoint until)
{
    for (;;) {
        if (auto event = client->next_event()) {
            return event;
        }
        if (!is_connected) {
            return client::ConnectionEvent{
                client::ConnectionEvent::Kind::Closed, 0, status::Bad_ConnectionClosed, {}, 0};
        }
        link->pump();
        context.restart();
        memory_return.look(detail::now());
        const TimePoint next = std::min(until, memory_return.next_deadline());
        if (context.run_one_until(next) == 0 && detail::now() >= until) {
            return std::nullopt;
        }
    }
}

std::optional<client::ConnectionEvent> ClientLoop::wait(Duration timeout)
{
    return impl_->wait(detail::now() + timeout);
}

Result<void> ClientLoop::wait_until_ready()
{
    const auto event = wait();
    if (!event) {
        return fail(status::Bad_Timeout);
    }
    if (event->kind == client::ConnectionEvent::Kind::Ready) {
        return {};
    }
    return fail(event->status.is_bad() ? event->status : status::Bad_ConnectionClosed);
}

Result<client::ConnectionEvent> ClientLoop::wait_for(std::uint32_t handle)
{
    while (auto event = wait()) {
        if (event->kind == client::ConnectionEvent::Kind::Closed) {
            return fail(event->status.is_bad() ? event->status : status::Bad_ConnectionClosed);
        }
        if (event->kind == client::ConnectionEvent::Kind::Response && event->handle == handle) {
            return *std::move(event);
        }
    }
    return fail(status::Bad_Timeout);
}

void ClientLoop::close()
{
    if (!impl_->client || !impl_->is_connected) {
        return;
    }
    impl_->client->close();
    const TimePoint until = detail::now() + std::chrono::seconds{2};
    impl_->link->pump();
    impl_->context.restart();
    while (impl_->is_connected && impl_->context.run_one_until(until) != 0) {
    }
}

} // namespace busbar::net

#include "served_server.hpp"

#include <utility>

#include <asio/post.hpp>

#include <busbar/core/status_codes.hpp>

namespace busbar::net::detail {

/// Without it a link would continue to read from a peer whose requests wait for their turn.
static_assert(requires(const server::Connection& connection) { connection.has_enough(); });

Result<void> ServedServer::adopt(asio::ip::tcp::socket& socket, Origin origin, std::uint64_t id)
{
    std::error_code error;
    const auto peer = socket.remote_endpoint(error);
    if (error) {
        return fail(status::Bad_CommunicationError);
    }
    auto connection = server_->connect(peer.address().to_string(), now());
    if (!connection) {
        return fail(connection.error()); // the log has the reason
    }
    auto owned = std::make_unique<server::Connection>(*std::move(connection));
    owned->came_by(origin.listener);
    if (origin.direction == Direction::ToClient) {
        if (auto greeted = owned->reverse_hello(server_->config().endpoint_url); !greeted) {
            return greeted;
        }
    }
    const std::uint64_t key = owned->id();
    auto link = std::make_shared<ConnectionLink>(
        std::move(socket), *owned,
        [this, id](ConnectionLink& changed) {
            drain(changed.engine(), id);
            events_->on_activity();
        },
        [this, key](ConnectionLink&) { asio::post(executor_, [this, key] { drop(key); }); },
        buffer_);
    clients_.emplace(key, Client{id, std::move(owned), link});
    link->start();
    events_->on_activity();
    return {};
}

/// The server itself logs the end of a connection.
void ServedServer::drain(server::Connection& connection, std::uint64_t id)
{
    while (const auto event = connection.next_event()) {
        if (event->kind == server::ConnectionEvent::Kind::Opened) {
            events_->on_opened(id);
        }
    }
}

void ServedServer::drop(std::uint64_t key)
{
    const auto found = clients_.find(key);
    const std::uint64_t id = found != clients_.end() ? found->second.id : 0;
    clients_.erase(key);
    const ServedEvents& events = *events_;
    events.on_ended(id);
    events.on_activity(); // which may destroy this, when it has no clients any more
}

void ServedServer::pump()
{
    while (const auto key = server_->next_changed()) {
        const auto found = clients_.find(*key);
        if (found != clients_.end()) {
            const auto link = found->second.link;
            link->pump();
        }
    }
}

} // namespace busbar::net::detail

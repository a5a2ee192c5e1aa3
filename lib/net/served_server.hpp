#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>

#include <asio/any_io_executor.hpp>
#include <asio/ip/tcp.hpp>

#include <busbar/core/result.hpp>
#include <busbar/server/server.hpp>

#include "link.hpp"

namespace busbar::net::detail {

/// The notifications of a ServedServer. `connection` is unique among all connections of the loop.
struct ServedEvents {
    std::function<void()> on_activity;
    std::function<void(std::uint64_t connection)> on_opened;
    std::function<void(std::uint64_t connection)> on_ended;
};

/// One Server and the sockets of its connections. All calls are made on the executor, which must
/// not run handlers any more when the object is destroyed, unless is_over().
class ServedServer {
public:
    enum class Direction : std::uint8_t { FromClient, ToClient };
    struct Origin {
        Direction direction;
        /// See server::Connection::came_by.
        std::uint32_t listener;
    };

    /// `server` and `events` must outlive the object.
    ServedServer(server::Server& server, const asio::any_io_executor& executor,
                 const ServedEvents& events)
        : server_{&server}, executor_{executor}, events_{&events}
    {
    }

    /// Gives the server a connection with the id `id`. The error is that of Server::connect, with
    /// the socket unchanged; Bad_CommunicationError if the peer is gone already.
    [[nodiscard]] Result<void> adopt(asio::ip::tcp::socket& socket, Origin origin,
                                     std::uint64_t id);
    /// Sends the changes on connections other than the one that caused them.
    void pump();
    /// True when its clients were notified, and their connections are closed.
    [[nodiscard]] bool is_over() const { return server_->is_stopped() && clients_.empty(); }
    [[nodiscard]] server::Server& server() const { return *server_; }
    void drop_all() { clients_.clear(); }

    /// Called once, when the loop does not use the server any more.
    std::function<void()> released;

private:
    using ConnectionLink = SocketLink<server::Connection>;
    struct Client {
        std::uint64_t id;
        std::unique_ptr<server::Connection> connection;
        std::shared_ptr<ConnectionLink> link;
    };

    void drain(server::Connection& connection, std::uint64_t id);
    void drop(std::uint64_t key);

    server::Server* server_;
    asio::any_io_executor executor_;
    const ServedEvents* events_;
    std::shared_ptr<ReadBuffer> buffer_{std::make_shared_for_overwrite<ReadBuffer>()};
    /// Clients by the server's own ids, which another server may have too.
    std::unordered_map<std::uint64_t, Client> clients_;
};

} // namespace busbar::net::detail

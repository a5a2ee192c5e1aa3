#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <asio/any_io_executor.hpp>
#include <asio/ip/tcp.hpp>

#include <busbar/net/reverse_listener.hpp>

#include "listener.hpp"

namespace busbar::net::detail {

/// The server that a client waits for; an empty field is not compared.
struct ExpectedServer {
    std::string server_uri;
    std::string endpoint_url;

    [[nodiscard]] bool is_met_by(const std::string& uri, const std::string& url) const;
};

/// Connections of servers on one side, clients that expect them on the other.
class ReverseQueue : public std::enable_shared_from_this<ReverseQueue> {
public:
    /// Identifies a client.
    using Ticket = std::uint64_t;
    /// Gets the connection, and the ReverseHello that was read from it.
    using Handler = std::function<void(asio::ip::tcp::socket, const std::vector<std::byte>& hello)>;

    ReverseQueue(asio::any_io_executor executor, LogSink& log, const ReverseListenerLimits& limits);

    [[nodiscard]] Result<std::uint16_t> listen(std::string_view address, std::uint16_t port);
    /// Closes everything.
    void stop();

    /// Admits the server from now on.
    [[nodiscard]] Ticket expect(ExpectedServer server);
    void forget(Ticket ticket);
    /// Calls `handler` later with a connection of the expected server, once, unless cancelled.
    void take(Ticket ticket, Handler handler);
    void cancel(Ticket ticket);

private:
    /// A peer that has connected.
    struct Caller;
    struct Client {
        ExpectedServer server;
        Handler handler; // null while it needs no connection
    };

    void admit(asio::ip::tcp::socket socket);
    void read_header(const std::shared_ptr<Caller>& caller);
    void read_body(const std::shared_ptr<Caller>& caller);
    void greet(const std::shared_ptr<Caller>& caller);
    void hold(const std::shared_ptr<Caller>& caller);
    void serve(Ticket ticket);
    void hand_over(const std::shared_ptr<Caller>& caller, Client& client);
    void limit(const std::shared_ptr<Caller>& caller, Duration time);
    void refuse(const std::shared_ptr<Caller>& caller, StatusCode status, const std::string& why);
    void drop(const std::shared_ptr<Caller>& caller);

    asio::any_io_executor executor_;
    LogSink* log_;
    ReverseListenerLimits limits_;
    std::vector<std::shared_ptr<Listener>> listeners_;
    std::list<std::shared_ptr<Caller>> callers_; // the oldest first
    std::map<Ticket, Client> clients_;
    Ticket next_ticket_{1};
};

} // namespace busbar::net::detail

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/result.hpp>

namespace busbar::server {

namespace detail {
class PeerLink;
} // namespace detail

/// What an owner of a connection may want to show or log.
struct ConnectionEvent {
    enum class Kind : std::uint8_t {
        Opened, // there is a SecureChannel
        Closed, // nothing more will come; what is in output() is still to be sent
    };
    Kind kind{Kind::Closed};
    /// Closed: Good if the client closed it.
    StatusCode status;
    /// Printable.
    std::string reason;
};

/// One client's connection to a Server, as an engine: bytes and the time go in, bytes and the next
/// deadline come out. Made by Server::connect. The Server must outlive it; both share one thread.
class BUSBAR_API Connection {
public:
    Connection(Connection&&) noexcept;
    Connection& operator=(Connection&&) noexcept;
    /// Sessions outlive their connection until they time out.
    ~Connection();

    /// Identifies the connection in Server::next_changed(); never given twice by one server.
    [[nodiscard]] std::uint64_t id() const;

    /// Begins with ReverseHello instead of waiting for Hello (Part 6, 7.1.2.6). Before any feed().
    [[nodiscard]] Result<void> reverse_hello(std::string_view endpoint_url);

    /// Which of several listeners the peer has connected to, by whatever numbers their owner has
    /// for them, for RoleMapper; 0 if it is not told. Before any feed().
    void came_by(std::uint32_t listener);

    /// Takes bytes and answers the requests that they complete. Bad once closed. While more output
    /// waits than the limits allow, requests stay unanswered until consume() has made room: do not
    /// read from the peer as long as there is output.
    ///
    /// A call does a bounded amount of work, whatever was asked for. What is left is done by
    /// handle_deadline(); next_deadline() is then not after the time that was given last. Serve
    /// other connections and the server first.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    /// Some of what was fed waits for its turn: read no more from the peer until handle_deadline()
    /// has done it, or what comes piles up here.
    [[nodiscard]] bool has_enough() const;
    [[nodiscard]] std::optional<ConnectionEvent> next_event();
    /// Bytes for the peer, valid until the next call of a member of the server or its connections.
    [[nodiscard]] std::span<const std::byte> output() const;
    void consume(std::size_t size);
    [[nodiscard]] TimePoint next_deadline() const;
    void handle_deadline(TimePoint now);
    [[nodiscard]] bool is_closed() const;

private:
    friend class Server;
    explicit Connection(std::unique_ptr<detail::PeerLink> link);

    std::unique_ptr<detail::PeerLink> link_;
};

} // namespace busbar::server

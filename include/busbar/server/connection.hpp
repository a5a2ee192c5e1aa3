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

/// An occurrence that the owner of a connection may want to show or log.
struct ConnectionEvent {
    /// The kind of occurrence.
    enum class Kind : std::uint8_t {
        Opened, // there is a SecureChannel
        Closed, // the last event; the rest of output() must still be sent
    };
    Kind kind{Kind::Closed};
    /// Closed: Good if the client closed it.
    StatusCode status;
    /// Printable.
    std::string reason;
};

/// One client's connection to a Server, as an engine: bytes and the time go in, bytes and the next
/// deadline come out. Created by Server::connect. The Server must outlive it; both share one
/// thread.
class BUSBAR_API Connection {
public:
    Connection(Connection&&) noexcept;
    Connection& operator=(Connection&&) noexcept;
    /// Sessions outlive their connection until they time out.
    ~Connection();

    /// Identifies the connection in Server::next_changed(); unique for the server's life.
    [[nodiscard]] std::uint64_t id() const;

    /// Begins with ReverseHello instead of waiting for Hello (Part 6, 7.1.2.6). Call it before
    /// feed().
    [[nodiscard]] Result<void> reverse_hello(std::string_view endpoint_url);

    /// Sets the listener that the peer has connected to, by a number that the owner chooses, for
    /// RoleMapper; 0 if it is not set. Call it before feed().
    void came_by(std::uint32_t listener);

    /// Takes bytes and answers the requests that they complete. Fails once closed. While more
    /// output waits than the limits allow, requests stay unanswered until consume() has made room:
    /// do not read from the peer as long as there is output.
    ///
    /// A call does a bounded amount of work, whatever was requested. handle_deadline() does the
    /// rest; next_deadline() is then not after the time that was passed last. Serve other
    /// connections and the server first.
    Result<void> feed(std::span<const std::byte> in, TimePoint now);
    /// True while some of the input waits for its turn: read no more from the peer until
    /// handle_deadline() has processed it, or the input accumulates here.
    [[nodiscard]] bool has_enough() const;
    [[nodiscard]] std::optional<ConnectionEvent> next_event();
    /// Bytes for the peer, valid until the next call of a member of the server or its connections.
    [[nodiscard]] std::span<const std::byte> output() const;
    /// Removes the first `size` bytes of output(), which were sent.
    void consume(std::size_t size);
    /// The time at which handle_deadline() has something to do; no_deadline if it has nothing.
    [[nodiscard]] TimePoint next_deadline() const;
    /// Does what is due at `now`.
    void handle_deadline(TimePoint now);
    [[nodiscard]] bool is_closed() const;

private:
    friend class Server;
    explicit Connection(std::unique_ptr<detail::PeerLink> link);

    std::unique_ptr<detail::PeerLink> link_;
};

} // namespace busbar::server

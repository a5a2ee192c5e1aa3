#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <netdb.h>
#include <sys/socket.h>

namespace busbar::bench {

/// A TCP connection that blocks, but not for long.
class Socket {
public:
    explicit Socket(int family);
    Socket(const Socket&) = delete;
    Socket& operator=(const Socket&) = delete;
    ~Socket();

    /// From `own_address` if that is not empty.
    [[nodiscard]] bool connect(const std::string& own_address, const ::addrinfo& peer) const;
    /// False when the peer is gone, or takes nothing for a second.
    [[nodiscard]] bool send(std::span<const std::byte> bytes) const;
    /// The first byte of what comes, which tells the messages of a handshake apart; 0 for nothing.
    [[nodiscard]] char answer(std::span<std::byte> room) const;
    /// The size of what has come within a second; 0 for nothing.
    [[nodiscard]] std::size_t receive(std::span<std::byte> room) const;
    /// Whether the peer ended the connection, or has said something, within 100 ms.
    [[nodiscard]] bool has_news() const;

private:
    int handle_;
};

/// The IPv4 address of a server, while it lives.
class Peer {
public:
    Peer(const std::string& host, const std::string& port);
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;
    ~Peer();

    /// Null if there is none.
    [[nodiscard]] const ::addrinfo* address() const { return found_; }

private:
    ::addrinfo* found_{nullptr};
};

} // namespace busbar::bench

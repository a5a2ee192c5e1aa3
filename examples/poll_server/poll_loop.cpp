#include "poll_loop.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace poll_server {

namespace {

using busbar::TimePoint;

TimePoint monotonic_now()
{
    return std::chrono::steady_clock::now();
}

bool would_block()
{
    return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

/// Reads no more from a peer that does not take its answers, or whose requests wait for their turn.
short wanted_events(const busbar::server::Connection& connection)
{
    if (!connection.output().empty()) {
        return POLLOUT;
    }
    return connection.has_enough() ? short{0} : short{POLLIN};
}

} // namespace

PollLoop::~PollLoop()
{
    for (const Peer& peer : peers_) {
        ::close(peer.socket);
    }
    if (listener_ >= 0) {
        ::close(listener_);
    }
}

bool PollLoop::listen(std::uint16_t port)
{
    listener_ = ::socket(AF_INET6, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (listener_ < 0) {
        return false;
    }
    const int on = 1;
    const int off = 0; // IPv4 comes by the same socket
    static_cast<void>(::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on));
    static_cast<void>(::setsockopt(listener_, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off));
    sockaddr_in6 address{};
    address.sin6_family = AF_INET6;
    address.sin6_port = htons(port);
    return ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
           ::listen(listener_, SOMAXCONN) == 0;
}

/// Milliseconds until the first deadline, of the server or of a connection.
int PollLoop::time_to_wait(std::chrono::milliseconds at_most) const
{
    TimePoint first = server_.next_deadline();
    for (const Peer& peer : peers_) {
        first = std::min(first, peer.connection.next_deadline());
    }
    const TimePoint now = monotonic_now();
    if (first <= now) {
        return 0;
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(first - now);
    return static_cast<int>(std::min(left, at_most).count());
}

bool PollLoop::step(std::chrono::milliseconds at_most)
{
    std::vector<pollfd> wanted;
    wanted.push_back({listener_, POLLIN, 0});
    for (const Peer& peer : peers_) {
        wanted.push_back({peer.socket, wanted_events(peer.connection), 0});
    }
    static_cast<void>(::poll(wanted.data(), wanted.size(), time_to_wait(at_most)));

    const TimePoint now = monotonic_now();
    // The server's own work first: what is due there is late for all clients.
    if (server_.next_deadline() <= now) {
        server_.handle_deadline(now);
    }
    auto event = wanted.begin() + 1;
    for (Peer& peer : peers_) {
        if ((event++->revents & ~POLLOUT) != 0) {
            receive(peer, now);
        }
        if (peer.connection.next_deadline() <= now) {
            peer.connection.handle_deadline(now);
        }
    }
    if (wanted.front().revents != 0) {
        accept_one(now);
    }
    // All connections are looked at below, so the names of those that changed are not needed.
    while (server_.next_changed()) {
    }
    peers_.remove_if([this](Peer& peer) {
        const bool is_done = !send(peer);
        if (is_done) {
            ::close(peer.socket);
        }
        return is_done;
    });
    return !server_.is_stopped();
}

void PollLoop::accept_one(TimePoint now)
{
    sockaddr_in6 address{};
    socklen_t size = sizeof address;
    const int accepted = ::accept4(listener_, reinterpret_cast<sockaddr*>(&address), &size,
                                   SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (accepted < 0) {
        return;
    }
    const int on = 1;
    static_cast<void>(::setsockopt(accepted, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on));
    std::array<char, INET6_ADDRSTRLEN> text{};
    static_cast<void>(::inet_ntop(AF_INET6, &address.sin6_addr, text.data(), text.size()));
    auto connection = server_.connect(text.data(), now);
    if (!connection) {
        ::close(accepted); // there is no room, and the log says so
        return;
    }
    peers_.push_back({accepted, *std::move(connection), false});
}

void PollLoop::receive(Peer& peer, TimePoint now)
{
    std::array<std::byte, 16 * 1024> bytes; // NOLINT(*-member-init): written by recv
    const ssize_t size = ::recv(peer.socket, bytes.data(), bytes.size(), 0);
    if (size > 0) {
        // Bad once it is closed, which send() sees too.
        static_cast<void>(
            peer.connection.feed(std::span{bytes}.first(static_cast<std::size_t>(size)), now));
    } else if (size == 0 || !would_block()) {
        peer.is_gone = true;
    }
}

bool PollLoop::send(Peer& peer)
{
    while (!peer.is_gone && !peer.connection.output().empty()) {
        const auto output = peer.connection.output();
        const ssize_t size = ::send(peer.socket, output.data(), output.size(), MSG_NOSIGNAL);
        if (size < 0) {
            return would_block();
        }
        peer.connection.consume(static_cast<std::size_t>(size));
    }
    return !peer.is_gone && !peer.connection.is_closed();
}

} // namespace poll_server

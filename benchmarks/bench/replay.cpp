#include "replay.hpp"

#include <array>
#include <span>

#include <arpa/inet.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <busbar/channel/endpoint_url.hpp>

namespace busbar::bench {

namespace {

constexpr int patience_ms = 100;

/// A TCP connection that blocks, but not for long.
class Socket {
public:
    explicit Socket(int family) : handle_{::socket(family, SOCK_STREAM, 0)} {}
    Socket(const Socket&) = delete;
    Socket& operator=(const Socket&) = delete;
    ~Socket()
    {
        if (handle_ >= 0) {
            ::close(handle_);
        }
    }

    [[nodiscard]] bool connect(const std::string& own_address, const ::addrinfo& peer) const
    {
        ::sockaddr_in own{};
        own.sin_family = AF_INET;
        if (!own_address.empty() &&
            (::inet_pton(AF_INET, own_address.c_str(), &own.sin_addr) != 1 ||
             ::bind(handle_, reinterpret_cast<const ::sockaddr*>(&own), sizeof own) != 0)) {
            return false;
        }
        return ::connect(handle_, peer.ai_addr, peer.ai_addrlen) == 0;
    }
    [[nodiscard]] bool send(std::span<const std::byte> bytes) const
    {
        return ::send(handle_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
               static_cast<::ssize_t>(bytes.size());
    }
    /// The first byte of what comes, which tells the messages of a handshake apart; 0 for nothing.
    [[nodiscard]] char answer(std::span<std::byte> room) const
    {
        ::pollfd waiting{handle_, POLLIN, 0};
        if (::poll(&waiting, 1, patience_ms) != 1) {
            return 0;
        }
        const auto size = ::recv(handle_, room.data(), room.size(), 0);
        return size > 0 ? static_cast<char>(room.front()) : char{0};
    }
    /// What recv() gave, all of it.
    [[nodiscard]] std::size_t receive(std::span<std::byte> room) const
    {
        ::pollfd waiting{handle_, POLLIN, 0};
        if (::poll(&waiting, 1, 10 * patience_ms) != 1) {
            return 0;
        }
        const auto size = ::recv(handle_, room.data(), room.size(), 0);
        return size > 0 ? static_cast<std::size_t>(size) : 0;
    }

private:
    int handle_;
};

/// The address of a server, while it lives.
class Peer {
public:
    explicit Peer(const Overheard& overheard)
    {
        ::addrinfo hints{};
        hints.ai_family = AF_INET;
        hints.ai_socktype = SOCK_STREAM;
        if (::getaddrinfo(overheard.host.c_str(), overheard.port.c_str(), &hints, &found_) != 0) {
            found_ = nullptr;
        }
    }
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;
    ~Peer()
    {
        if (found_ != nullptr) {
            ::freeaddrinfo(found_);
        }
    }
    [[nodiscard]] const ::addrinfo* address() const { return found_; }

private:
    ::addrinfo* found_{nullptr};
};

std::vector<std::byte> taken(channel::ClientChannel& client)
{
    const auto out = client.output();
    std::vector<std::byte> bytes{out.begin(), out.end()};
    client.consume(bytes.size());
    return bytes;
}

/// Whether the server did the work.
bool replay_once(const Overheard& overheard, const std::string& own_address,
                 const ::addrinfo& address)
{
    std::array<std::byte, 4'096> room;
    const Socket socket{address.ai_family};
    return socket.connect(own_address, address) && socket.send(overheard.hello) &&
           socket.answer(room) == 'A' && socket.send(overheard.open) && socket.answer(room) == 'O';
}

} // namespace

Result<Overheard> overhear(Load& load, const std::string& url)
{
    const auto endpoint = channel::EndpointUrl::parse(url);
    if (!endpoint) {
        return fail(status::Bad_TcpEndpointUrlInvalid);
    }
    Overheard overheard{endpoint->host, std::to_string(endpoint->port), {}, {}};
    const Peer peer{overheard};
    auto client = load.make_channel();
    overheard.hello = taken(client);
    std::array<std::byte, 4'096> room;
    if (peer.address() == nullptr) {
        return fail(status::Bad_CommunicationError);
    }
    const Socket socket{peer.address()->ai_family};
    if (!socket.connect({}, *peer.address()) || !socket.send(overheard.hello)) {
        return fail(status::Bad_CommunicationError);
    }
    const std::size_t size = socket.receive(room);
    if (!client.feed(std::span{room}.first(size), clock_now())) {
        return fail(status::Bad_CommunicationError);
    }
    while (client.next_event()) {
    }
    overheard.open = taken(client);
    if (overheard.open.empty()) {
        return fail(status::Bad_CommunicationError);
    }
    return overheard;
}

void replay(const Overheard& overheard, const std::string& own_address, Tally& tally)
{
    const Peer peer{overheard};
    while (!tally.is_over && peer.address() != nullptr) {
        const bool is_answered = replay_once(overheard, own_address, *peer.address());
        ++(is_answered ? tally.answered : tally.refused);
    }
}

} // namespace busbar::bench

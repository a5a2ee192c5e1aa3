#include "socket.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/time.h>
#include <unistd.h>

namespace busbar::bench {

namespace {

constexpr int patience_ms = 100;

bool has_come(int handle, int timeout_ms)
{
    ::pollfd waiting{handle, POLLIN, 0};
    return ::poll(&waiting, 1, timeout_ms) == 1;
}

std::size_t take(int handle, std::span<std::byte> room)
{
    const auto size = ::recv(handle, room.data(), room.size(), 0);
    return size > 0 ? static_cast<std::size_t>(size) : 0;
}

} // namespace

Socket::Socket(int family) : handle_{::socket(family, SOCK_STREAM, 0)}
{
    const ::timeval limit{1, 0};
    ::setsockopt(handle_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
}

Socket::~Socket()
{
    if (handle_ >= 0) {
        ::close(handle_);
    }
}

bool Socket::connect(const std::string& own_address, const ::addrinfo& peer) const
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

bool Socket::send(std::span<const std::byte> bytes) const
{
    while (!bytes.empty()) {
        const auto size = ::send(handle_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (size <= 0) {
            return false;
        }
        bytes = bytes.subspan(static_cast<std::size_t>(size));
    }
    return true;
}

char Socket::answer(std::span<std::byte> room) const
{
    return has_news() && take(handle_, room) != 0 ? static_cast<char>(room.front()) : char{0};
}

std::size_t Socket::receive(std::span<std::byte> room) const
{
    return has_come(handle_, 10 * patience_ms) ? take(handle_, room) : 0;
}

bool Socket::has_news() const
{
    return has_come(handle_, patience_ms);
}

Peer::Peer(const std::string& host, const std::string& port)
{
    ::addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_STREAM;
    if (::getaddrinfo(host.c_str(), port.c_str(), &hints, &found_) != 0) {
        found_ = nullptr;
    }
}

Peer::~Peer()
{
    if (found_ != nullptr) {
        ::freeaddrinfo(found_);
    }
}

} // namespace busbar::bench

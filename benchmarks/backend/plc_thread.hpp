#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <busbar/core/clock.hpp>

namespace busbar::bench {

/// The PLC's end of one connection, on a thread of its own. `Responder` is one of the harness; it
/// must outlive the object, and is used by that thread alone.
template <typename Responder>
class PlcThread {
public:
    /// Takes the port; start() takes the connection.
    explicit PlcThread(Responder& responder) : responder_{responder}
    {
        listener_ = ::socket(AF_INET, SOCK_STREAM, 0);
        ::sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        ::socklen_t size = sizeof address;
        if (::bind(listener_, reinterpret_cast<::sockaddr*>(&address), size) != 0 ||
            ::listen(listener_, 4) != 0 ||
            ::getsockname(listener_, reinterpret_cast<::sockaddr*>(&address), &size) != 0) {
            throw std::runtime_error{"no port for a PLC"};
        }
        port_ = ntohs(address.sin_port);
    }
    PlcThread(const PlcThread&) = delete;
    PlcThread& operator=(const PlcThread&) = delete;
    /// Call it when the connection has ended.
    ~PlcThread()
    {
        ::shutdown(listener_, SHUT_RDWR);
        if (thread_.joinable()) {
            thread_.join();
        }
        ::close(listener_);
    }

    /// Starts the thread, which calls `before_requests` whenever something has come.
    void start(std::function<void()> before_requests = {})
    {
        before_requests_ = std::move(before_requests);
        thread_ = std::thread{[this] { serve(); }};
    }
    [[nodiscard]] std::uint16_t port() const { return port_; }

private:
    void serve()
    {
        const int socket = ::accept(listener_, nullptr, nullptr);
        if (socket < 0) {
            return;
        }
        const int at_once = 1;
        ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
        std::array<std::byte, 65'536> buffer;
        for (;;) {
            const auto got = ::recv(socket, buffer.data(), buffer.size(), 0);
            if (got <= 0) {
                break;
            }
            if (before_requests_) {
                before_requests_();
            }
            const auto now =
                std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
            static_cast<void>(
                responder_.feed(std::span{buffer}.first(static_cast<std::size_t>(got)), now));
            for (auto out = responder_.output(); !out.empty(); out = responder_.output()) {
                const auto sent = ::send(socket, out.data(), out.size(), MSG_NOSIGNAL);
                if (sent <= 0) {
                    ::close(socket);
                    return;
                }
                responder_.consume(static_cast<std::size_t>(sent));
            }
        }
        ::close(socket);
    }

    Responder& responder_;
    std::function<void()> before_requests_;
    int listener_{-1};
    std::uint16_t port_{0};
    std::thread thread_;
};

} // namespace busbar::bench

#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <asio/ip/tcp.hpp>

#include <busbar/harness/link.hpp>

namespace busbar::harness::detail {

/// A real peer as the end of a link in a world: what its socket receives is sent on the link, what
/// arrives on the link is written to the socket. The link's end is the socket's and the other way
/// round; a link that was cut is a reset for the peer. Keeps itself until both are over.
class SocketEnd final : public LinkEnd, public std::enable_shared_from_this<SocketEnd> {
public:
    SocketEnd(asio::ip::tcp::socket socket, Side side) : socket_{std::move(socket)}, side_{side} {}

    /// Takes part in the link, with a socket that is connected.
    void begin(std::shared_ptr<Link> link);
    /// Connects first; what arrives on the link meanwhile waits. If that fails, the link is lost
    /// and `failed` is told the reason.
    void begin(std::shared_ptr<Link> link, const asio::ip::tcp::resolver::results_type& addresses,
               std::function<void(const std::string& why)> failed);
    /// Leaves the link and closes the socket at once.
    void stop();

    [[nodiscard]] std::span<const std::byte> output() const override { return received_; }
    void consume(std::size_t size) override;
    void feed(std::span<const std::byte> in) override;
    void link_lost() override;

private:
    /// A peer that does not read makes us hold no more than this.
    static constexpr std::size_t max_unsent = 64U << 20U;

    void read();
    void write();
    /// The socket has ended: properly, if the peer closed it.
    void socket_lost(bool is_proper);
    void close_socket(bool is_reset);

    asio::ip::tcp::socket socket_;
    Side side_;
    std::shared_ptr<Link> link_;
    std::vector<std::byte> incoming_;
    std::vector<std::byte> received_;
    std::vector<std::byte> unsent_;
    std::vector<std::byte> writing_;
    bool is_connected_{false};
    /// The link is over: the socket is closed when all has been written.
    bool is_ending_{false};
};

} // namespace busbar::harness::detail

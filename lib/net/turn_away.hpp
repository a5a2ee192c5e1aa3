#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include <asio/ip/tcp.hpp>

#include <busbar/core/status_code.hpp>

namespace busbar::net::detail {

/// Tells peers that there is no room for them: sends an Error message (Part 6, 7.1.2.5), and closes
/// the connection when the peer has read that or after a second. More than `limit` peers at a time
/// are closed without a message. Runs on the executor of the sockets.
class TurnAway {
public:
    explicit TurnAway(std::size_t limit) : places_{std::make_shared<std::size_t>(limit)} {}

    void operator()(asio::ip::tcp::socket socket, StatusCode error, std::string_view reason);

private:
    std::shared_ptr<std::size_t> places_; // number of free places
};

} // namespace busbar::net::detail

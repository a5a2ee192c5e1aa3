#pragma once

#include <asio/ip/tcp.hpp>

namespace busbar::net::detail {

/// Has TCP find out that the peer or the network has gone, for a connection on which nothing may be
/// said for days: after a minute of silence, and six questions ten seconds apart that nobody
/// answers. Where the system has no such setting, its own times hold.
void keep_alive(asio::ip::tcp::socket& socket);

} // namespace busbar::net::detail

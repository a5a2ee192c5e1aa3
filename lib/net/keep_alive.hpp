#pragma once

#include <asio/ip/tcp.hpp>

namespace busbar::net::detail {

/// Makes TCP find out that the peer or the network has gone, for a connection that may be silent
/// for days: after a minute of silence, and six unanswered probes ten seconds apart. On a system
/// without this setting its own times apply.
void keep_alive(asio::ip::tcp::socket& socket);

} // namespace busbar::net::detail

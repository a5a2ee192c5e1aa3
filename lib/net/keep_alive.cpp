#include "keep_alive.hpp"

#include <asio/socket_base.hpp>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace busbar::net::detail {

void keep_alive(asio::ip::tcp::socket& socket)
{
    std::error_code ignored;
    socket.set_option(asio::socket_base::keep_alive{true}, ignored);
#if defined(TCP_KEEPIDLE) && defined(TCP_KEEPINTVL) && defined(TCP_KEEPCNT)
    const auto set = [&](int option, int value) {
        static_cast<void>(
            ::setsockopt(socket.native_handle(), IPPROTO_TCP, option, &value, sizeof value));
    };
    set(TCP_KEEPIDLE, 60);
    set(TCP_KEEPINTVL, 10);
    set(TCP_KEEPCNT, 6);
#endif
}

} // namespace busbar::net::detail

#pragma once

#include <cstdint>
#include <list>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>

namespace busbar::test {

/// A port whose queue is full, so that who connects to it hears nothing: neither yes nor no.
class FullPort {
public:
    FullPort(const char* address, std::uint16_t number)
    {
        acceptor_.open(asio::ip::tcp::v4());
        acceptor_.bind({asio::ip::make_address(address), number});
        acceptor_.listen(1); // and one more
        port = acceptor_.local_endpoint().port();
        for (int i = 0; i < 2; ++i) {
            waiting_.emplace_back(context_).connect(acceptor_.local_endpoint());
        }
    }

    std::uint16_t port{0};

private:
    asio::io_context context_;
    asio::ip::tcp::acceptor acceptor_{context_};
    std::list<asio::ip::tcp::socket> waiting_;
};

} // namespace busbar::test

#include "listener.hpp"

#include <chrono>
#include <string>
#include <utility>

#include <asio/ip/v6_only.hpp>

namespace busbar::net::detail {

using asio::ip::tcp;

Result<std::uint16_t> Listener::open(std::string_view address, std::uint16_t port)
{
    auto error = bind(address, port);
    if (!error) {
        acceptor_.listen(asio::socket_base::max_listen_connections, error);
    }
    if (error) {
        log_->write(LogLevel::Error, "net",
                    "cannot listen on " + std::string{address} + ":" + std::to_string(port) + ": " +
                        error.message());
        return fail(status::Bad_CommunicationError);
    }
    return acceptor_.local_endpoint(error).port();
}

std::error_code Listener::bind(std::string_view address, std::uint16_t port)
{
    std::error_code error;
    auto ip = address.empty() ? asio::ip::address{asio::ip::address_v6::any()}
                              : asio::ip::make_address(std::string{address}, error);
    if (error) {
        return error;
    }
    acceptor_.open(ip.is_v6() ? tcp::v6() : tcp::v4(), error);
    if (error && address.empty()) { // a machine without IPv6
        ip = asio::ip::address_v4::any();
        acceptor_.open(tcp::v4(), error);
    }
    if (!error && ip.is_v6()) {
        acceptor_.set_option(asio::ip::v6_only{!address.empty()}, error);
    }
    if (!error) {
        acceptor_.set_option(tcp::acceptor::reuse_address{true}, error);
    }
    if (!error) {
        acceptor_.bind({ip, port}, error);
    }
    return error;
}

void Listener::start(Handler handler)
{
    handler_ = std::move(handler);
    accept();
}

void Listener::close()
{
    handler_ = nullptr;
    pause_.cancel();
    std::error_code ignored;
    acceptor_.close(ignored);
}

void Listener::accept()
{
    if (!handler_) {
        return;
    }
    acceptor_.async_accept([self = shared_from_this()](std::error_code error, tcp::socket socket) {
        self->accepted(error, std::move(socket));
    });
}

void Listener::accepted(std::error_code error, tcp::socket socket)
{
    if (!handler_) {
        return;
    }
    if (!error) {
        const Handler handler = handler_; // which may close this
        handler(std::move(socket));
        accept();
        return;
    }
    log_->write(LogLevel::Warning, "net", "accept: " + error.message());
    // Most likely there are no more file descriptors, and the peer still waits: asking again at
    // once would only burn time and fill the log.
    pause_.expires_after(std::chrono::milliseconds{100});
    pause_.async_wait([self = shared_from_this()](std::error_code cancelled) {
        if (!cancelled) {
            self->accept();
        }
    });
}

} // namespace busbar::net::detail

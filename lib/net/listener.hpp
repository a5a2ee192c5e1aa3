#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>

#include <asio/any_io_executor.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/steady_timer.hpp>

#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>

namespace busbar::net::detail {

/// A port that peers connect to. All calls on the executor.
class Listener : public std::enable_shared_from_this<Listener> {
public:
    using Handler = std::function<void(asio::ip::tcp::socket)>;

    Listener(const asio::any_io_executor& executor, LogSink& log)
        : acceptor_{executor}, pause_{executor}, log_{&log}
    {
    }

    /// "" is every address of the machine, IPv4 and IPv6; port 0 any that is free. The port, or
    /// Bad_CommunicationError with the reason in the log.
    [[nodiscard]] Result<std::uint16_t> open(std::string_view address, std::uint16_t port);
    /// Calls `handler` for each peer until close().
    void start(Handler handler);
    void close();

private:
    [[nodiscard]] std::error_code bind(std::string_view address, std::uint16_t port);
    void accept();
    void accepted(std::error_code error, asio::ip::tcp::socket socket);

    asio::ip::tcp::acceptor acceptor_;
    asio::steady_timer pause_;
    LogSink* log_;
    Handler handler_; // null once closed
};

} // namespace busbar::net::detail

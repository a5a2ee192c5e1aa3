#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "listener.hpp"

namespace busbar::net::detail {

/// All ports of one server. All calls are made on the executor.
class Listeners {
public:
    Listeners(asio::any_io_executor executor, LogSink& log)
        : executor_{std::move(executor)}, log_{&log}
    {
    }

    /// Called with the number of the listener that a peer came by.
    using Handler = std::function<void(asio::ip::tcp::socket, std::uint32_t listener)>;

    /// See Listener::open. After start() peers are accepted at once.
    [[nodiscard]] Result<std::uint16_t> add(std::string_view address, std::uint16_t port,
                                            std::uint32_t listener);
    /// See Listener::reserve; before start().
    [[nodiscard]] Result<std::uint16_t> reserve(std::string_view address, std::uint16_t port,
                                                std::uint32_t listener);
    /// Listens on all ports that were reserved.
    [[nodiscard]] Result<void> listen();
    /// Calls `handler` for each peer until close().
    void start(Handler handler);
    /// Closes the ports with this number, if there are any.
    void remove(std::uint16_t port);
    void close();
    /// See Listener::resume.
    void resume();

private:
    struct Port {
        std::uint16_t number;
        std::uint32_t listener_number;
        std::shared_ptr<Listener> listener;
    };

    void start(const Port& port) const;

    asio::any_io_executor executor_;
    LogSink* log_;
    std::vector<Port> ports_;
    Handler handler_; // null before start() and once closed
};

} // namespace busbar::net::detail

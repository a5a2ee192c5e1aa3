#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <asio/any_io_executor.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/ip/udp.hpp>

#include <busbar/backend/device.hpp>
#include <busbar/core/log.hpp>

#include "clock.hpp"
#include "connector.hpp"
#include "link.hpp"
#include "name_lookup.hpp"

namespace busbar::net::detail {

/// The datagrams between a device and its PLC: a frame each. Lives as long as its handlers do.
class DatagramLink : public std::enable_shared_from_this<DatagramLink> {
public:
    /// `on_end` is called once, with the reason, when the socket is of no use any more.
    DatagramLink(const asio::any_io_executor& executor, backend::Device& device,
                 std::function<void(const std::string&)> on_end);

    /// Takes a socket of its own. The error of the system, if it gives none.
    [[nodiscard]] std::error_code open(const asio::ip::udp::endpoint& peer);
    /// Begins to send and to receive.
    void start();
    /// Sends what the device has to say, and waits for its deadline.
    void pump();
    /// Closes the socket; on_end is not called.
    void close();

private:
    void receive();
    void end(const std::string& reason);

    asio::ip::udp::socket socket_;
    DeadlineTimer timer_;
    backend::Device* device_;
    std::function<void(const std::string&)> on_end_; // null once ended
    std::vector<std::byte> buffer_;
};

/// Carries out what one Device wants: connections, bytes, time. All calls are made on the executor.
class DeviceLink : public std::enable_shared_from_this<DeviceLink> {
public:
    /// `device` and `log` must live until stop().
    DeviceLink(const asio::any_io_executor& executor, backend::Device& device, LogSink& log);
    DeviceLink(const DeviceLink&) = delete;
    DeviceLink& operator=(const DeviceLink&) = delete;
    ~DeviceLink() = default;

    void start();
    /// Drops the connection; the device is not used any more.
    void stop();

private:
    using StreamLink = SocketLink<backend::Device>;

    void look();
    void connect();
    void found(const std::vector<asio::ip::address>& addresses);
    void connected(Expected<asio::ip::tcp::socket, Unreached> socket);
    void lost(const std::string& reason);

    asio::any_io_executor executor_;
    backend::Device* device_; // null once stopped
    LogSink* log_;
    NullLog no_log_; // the device tells what the Connector would
    Connector connector_;
    NameLookup names_;
    DeadlineTimer timer_;
    std::shared_ptr<StreamLink> stream_;
    std::shared_ptr<DatagramLink> datagrams_;
};

} // namespace busbar::net::detail

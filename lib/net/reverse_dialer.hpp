#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <set>

#include <busbar/net/reverse_connect.hpp>

#include "clock.hpp"
#include "connector.hpp"

namespace busbar::net::detail {

/// Makes sure that one client always has an unused connection (Part 6, 7.1.3). All calls are made
/// on the executor, which must not run handlers any more when the object is destroyed.
class ReverseDialer {
public:
    /// Gives the server a connection to the client and returns its id; none if the server refused
    /// it.
    using Adopt = std::function<std::optional<std::uint64_t>(asio::ip::tcp::socket)>;

    /// `log` and `config` must outlive the object.
    ReverseDialer(const asio::any_io_executor& executor, LogSink& log, channel::EndpointUrl url,
                  const ReverseConnectConfig& config, Adopt adopt);

    void start();
    void stop();
    /// A connection, perhaps one of ours, has a SecureChannel: another one is needed.
    void opened(std::uint64_t connection);
    /// A connection, perhaps one of ours, has ended.
    void ended(std::uint64_t connection);

private:
    void dial();
    void connected(Expected<asio::ip::tcp::socket, Unreached> socket);
    void dial_later();

    LogSink* log_;
    const channel::EndpointUrl url_;
    const ReverseConnectConfig* config_;
    Adopt adopt_;
    Connector connector_;
    DeadlineTimer timer_;
    std::minstd_rand random_{std::random_device{}()};
    std::optional<std::uint64_t> spare_;
    TimePoint spare_since_{};
    std::set<std::uint64_t> used_;
    Duration delay_;
    bool is_dialing_{false}; // or waits to dial
    bool has_stopped_{false};
};

} // namespace busbar::net::detail

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>
#include <busbar/net/discovery_registration.hpp>
#include <busbar/net/reverse_connect.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::net {

/// Serves one Server over TCP on the thread that calls run().
///
/// Make it before the Server, which is given waker(); then call listen(), then run(). What a user's
/// callback throws ends the request it was called for; a request that finds no memory ends its
/// connection. Both are logged, and everything else goes on.
class BUSBAR_API ServerLoop {
public:
    explicit ServerLoop(LogSink& log);
    ServerLoop(const ServerLoop&) = delete;
    ServerLoop& operator=(const ServerLoop&) = delete;
    ~ServerLoop();

    /// Wakes the loop for data sources; from any thread, without blocking or allocating.
    [[nodiscard]] server::Waker& waker();
    /// Listens on `address` ("" is every address of the machine, IPv4 and IPv6) and `port` (0 is
    /// any that is free). Gives the port, or Bad_CommunicationError with the reason in the log.
    [[nodiscard]] Result<std::uint16_t> listen(std::string_view address, std::uint16_t port);
    /// Connects to clients that cannot reach the server, from run() on, and keeps one connection to
    /// each open that waits to be used. Bad_TcpEndpointUrlInvalid. Once, before run().
    [[nodiscard]] Result<void> connect_to_clients(ReverseConnectConfig config);
    /// Keeps the server registered with a discovery server from run() on, and takes the
    /// registration back when it is stopped, which may take up to settings.farewell longer. What
    /// `environment` points to must live until run() has returned. Errors are those of
    /// Registration::check, and Bad_TcpEndpointUrlInvalid. Before run(); once for each discovery
    /// server.
    [[nodiscard]] Result<void> register_with(DiscoveryRegistrationConfig config,
                                             const channel::ChannelEnvironment& environment);
    /// Ends run() cleanly when the process gets SIGINT or SIGTERM.
    void stop_on_signals();
    /// Calls `handler` on the loop's thread each time the process gets SIGHUP, which no longer ends
    /// it: to read again what may have changed. Once, before run().
    void on_hangup(std::function<void()> handler);
    /// Returns when the server has stopped: clients see State Shutdown first, then their
    /// connections are closed. `server` must live until then.
    void run(server::Server& server);
    /// Begins the server's shutdown. From any thread.
    void stop();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::net

#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/result.hpp>
#include <busbar/net/discovery_registration.hpp>
#include <busbar/net/reverse_connect.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::net {

/// How clients of a server learn that another one takes its place; see ServerLoop::hand_over.
struct Handover {
    /// ServerStatus.ShutdownReason; not empty.
    std::string reason;
    /// How long they are told before their connections are closed; a day at most.
    std::chrono::seconds delay{2};
    /// EstimatedReturnTime. None: when the connections are closed, as the next server is there.
    DateTime return_time{};
    /// Called once on the loop's thread when the loop does not use the server that went any more,
    /// and run() has not returned: it may be destroyed in here. May be null.
    std::function<void()> released{};
};

/// Serves one Server over TCP on the thread that calls run(), and another one after it.
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
    /// Before run(), or within it on its thread: who connects is served at once then. Connections
    /// come by that listener, see Connection::came_by.
    [[nodiscard]] Result<std::uint16_t> listen(std::string_view address, std::uint16_t port,
                                               std::uint32_t listener = 0);
    /// Closes the port that listen() gave, at all its addresses; connections stay. As listen().
    void stop_listening(std::uint16_t port);
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
    /// Ends run() cleanly when the process gets SIGINT or SIGTERM. Calls `first` before, on the
    /// loop's thread, to save what must not be lost if the process does not live longer; it may be
    /// null. Once, before run().
    void stop_on_signals(std::function<void()> first = {});
    /// Calls `handler` on the loop's thread each time the process gets SIGHUP, which no longer ends
    /// it: to read again what may have changed. Once, before run().
    void on_hangup(std::function<void()> handler);
    /// Calls `work` soon on the loop's thread, in nobody's callback: to change what it serves. From
    /// any thread. Not called if run() returns before.
    void post(std::function<void()> work);
    /// From now on `next` serves who connects at the same listeners, which stay open, and the
    /// clients that are connected to; discovery registrations go on. The server before begins its
    /// shutdown: clients that have a session there see State Shutdown, the reason and the return
    /// time, are answered Bad_Shutdown to all but Read, Publish and CloseSession, and lose their
    /// connection after the delay. One that connects again finds `next`. Sessions and Subscriptions
    /// do not go over.
    ///
    /// On the loop's thread, while run() runs, and not in a callback of a server's: from post() or
    /// on_hangup(). Both servers are of that thread then. The loop borrows `next`, which must live,
    /// as must all that it was made of, until it is handed over itself and `released` was called,
    /// or until run() has returned. May be called again at once; servers that went end one by one.
    ///
    /// Both are given the loop's waker(). Until it is released, the server that went gets its
    /// deadlines and completions: requests that wait for its data sources end as in any shutdown,
    /// and batches that outlive it are dropped when they complete. A DataSource that uses the waker
    /// is added to one of the two only; what other threads hold must not be freed in `released`.
    ///
    /// Refused, with the server before serving on as if nothing had been asked for: run() does not
    /// run or ends; `next` serves already, has connections or was shut down; it has another
    /// application_uri than the one that is registered with a discovery server; the Handover's
    /// reason is empty, or its delay out of range.
    [[nodiscard]] Configured<void> hand_over(server::Server& next, Handover handover);
    /// Returns when the server has stopped: clients see State Shutdown first, then their
    /// connections are closed. `server` must live until then, or until it is handed over.
    void run(server::Server& server);
    /// Begins the server's shutdown. Servers that went before have no longer than that takes. From
    /// any thread.
    void stop();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::net

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/result.hpp>
#include <busbar/net/discovery_registration.hpp>
#include <busbar/net/reverse_connect.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::net {

/// Says how clients of a server learn that another one takes its place; see ServerLoop::hand_over.
struct Handover {
    /// ServerStatus.ShutdownReason; not empty.
    std::string reason;
    /// Time between the announcement and the end of their connections; at most a day.
    std::chrono::seconds delay{2};
    /// EstimatedReturnTime. If null, the time at which the connections are closed, as the next
    /// server is running.
    DateTime return_time{};
    /// Called once on the loop's thread when the loop does not use the replaced server any more,
    /// and run() has not returned: it may be destroyed in this call. May be null.
    std::function<void()> released{};
};

/// Serves one Server over TCP on the thread that calls run(), and another one after it.
///
/// Create it before the Server, which gets waker(); then call listen(), then run(). An exception of
/// a user's callback ends the request it was called for; a request that finds no memory ends its
/// connection. Both are logged, and everything else continues. Creating one sets M_TRIM_THRESHOLD
/// and M_MMAP_THRESHOLD of glibc's malloc for the whole process, which then keeps freed memory for
/// the next request; run() returns it to the system when it is idle.
class BUSBAR_API ServerLoop {
public:
    explicit ServerLoop(LogSink& log);
    ServerLoop(const ServerLoop&) = delete;
    ServerLoop& operator=(const ServerLoop&) = delete;
    ~ServerLoop();

    /// Wakes the loop for data sources; called from any thread, without blocking or allocating.
    [[nodiscard]] server::Waker& waker();
    /// Listens on `address` ("" means every address of the machine, IPv4 and IPv6) and `port` (0
    /// means any free one). Returns the port, or Bad_CommunicationError with the reason in the log.
    /// Call it before run(), or during it on its thread: connections are then served at once. They
    /// come by this listener, see Connection::came_by.
    [[nodiscard]] Result<std::uint16_t> listen(std::string_view address, std::uint16_t port,
                                               std::uint32_t listener = 0);
    /// Does as listen() does, but peers are refused until listen_on_reserved(): a program that
    /// needs a while for its server reserves the port first, and no peer waits for an answer. Call
    /// it before run().
    [[nodiscard]] Result<std::uint16_t> reserve(std::string_view address, std::uint16_t port,
                                                std::uint32_t listener = 0);
    /// Listens on all ports that were reserved, right before run(). Bad_CommunicationError, with
    /// the reason in the log, if another program was faster.
    [[nodiscard]] Result<void> listen_on_reserved();
    /// Closes the port that listen() returned, at all its addresses; connections stay. Called like
    /// listen().
    void stop_listening(std::uint16_t port);
    /// Connects to clients that cannot reach the server, during run(), and keeps one unused
    /// connection to each open. Bad_TcpEndpointUrlInvalid. Call it once, before run().
    [[nodiscard]] Result<void> connect_to_clients(ReverseConnectConfig config);
    /// Keeps the server registered with a discovery server during run(), and unregisters it when it
    /// is stopped, which may take up to settings.farewell longer. The objects of `environment` must
    /// live until run() has returned. Errors are those of Registration::check, and
    /// Bad_TcpEndpointUrlInvalid. Call it before run(), once for each discovery server.
    [[nodiscard]] Result<void> register_with(DiscoveryRegistrationConfig config,
                                             const channel::ChannelEnvironment& environment);
    /// Unregisters the server while run() continues, as for a server that serves only
    /// administrators. Call it on the loop's thread, during run().
    void unregister();
    /// Registers the server again after unregister(). Call it like that.
    void register_again();
    /// Ends run() cleanly when the process gets SIGINT or SIGTERM. Calls `first` before, on the
    /// loop's thread, to save what must not be lost if the process is killed soon; it may be null.
    /// Call it once, before run().
    void stop_on_signals(std::function<void()> first = {});
    /// Calls `handler` on the loop's thread each time the process gets SIGHUP, which no longer ends
    /// it: to read changed files again. Call it once, before run().
    void on_hangup(std::function<void()> handler);
    /// Calls `work` soon on the loop's thread, outside any callback: to change what it serves.
    /// Called from any thread. Not executed if run() returns before.
    void post(std::function<void()> work);
    /// Lets `next` serve new connections at the same listeners, which stay open, and the clients
    /// that the server connects to; discovery registrations continue. The previous server begins
    /// its shutdown: clients that have a session there see State Shutdown, the reason and the
    /// return time, get Bad_Shutdown for all requests except Read, Publish and CloseSession, and
    /// lose their connection after the delay. When they connect again they find `next`. Sessions
    /// and Subscriptions are not transferred.
    ///
    /// Call it on the loop's thread, while run() runs, and not in a callback of a server: from
    /// post() or on_hangup(). Both servers use that thread then. The loop borrows `next`, which
    /// must live, as must everything that it uses, until it is handed over itself and `released`
    /// was called, or until run() has returned. May be called again at once; replaced servers end
    /// one by one.
    ///
    /// Both get the loop's waker(). Until it is released, the previous server gets its deadlines
    /// and completions: requests that wait for its data sources end as in any shutdown, and batches
    /// that outlive it are dropped. A DataSource that uses the waker is added to one of the two
    /// only; objects that other threads hold must not be freed in `released`. Refused, with nothing
    /// changed, if run() does not run or is ending; if `next` is served already, has connections,
    /// was shut down, or has another application_uri than a discovery server knows; and if the
    /// reason is empty or the delay out of range.
    [[nodiscard]] Configured<void> hand_over(server::Server& next, Handover handover);
    /// Returns when the server has stopped: clients see State Shutdown first, then their
    /// connections are closed. `server` must live until then, or until it is handed over.
    void run(server::Server& server);
    /// Serves as run() does for at most `time`, or does only what is due for 0: for a program that
    /// has other work on the same thread. Call it again with the same server to continue; between
    /// two calls the program may change the server. False once the server has stopped, also because
    /// the first call failed for lack of memory, which throws std::bad_alloc. A program that does
    /// not wait for that calls end_at_once() before the server is destroyed.
    [[nodiscard]] bool run_for(server::Server& server, Duration time);
    /// Closes the ports and drops all connections of run_for(), which returns false from now on.
    /// Call it between calls of run_for(), not during one.
    void end_at_once();
    /// Begins the server's shutdown. Servers that were replaced before are given no more time than
    /// it takes. Called from any thread.
    void stop();

private:
    friend class DeviceDriver;

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::net

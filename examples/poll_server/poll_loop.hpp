#pragma once

#include <chrono>
#include <cstdint>
#include <list>

#include <busbar/server/server.hpp>

namespace poll_server {

/// A loop around a Server with the sockets of the operating system and poll(): no further library,
/// no thread, no exception. Any loop does with server and connections what this one does; on
/// another system, replace the sockets.
///
/// The sources of this server answer at once, so that its Waker is never called. A loop for other
/// sources makes a descriptor readable there, and calls handle_completions() when it wakes up.
class PollLoop {
public:
    /// `server` must outlive the loop.
    explicit PollLoop(busbar::server::Server& server) : server_{server} {}
    PollLoop(const PollLoop&) = delete;
    PollLoop& operator=(const PollLoop&) = delete;
    ~PollLoop();

    /// Listens on every address of the machine; false if the port is not available.
    [[nodiscard]] bool listen(std::uint16_t port);
    /// Waits until there is something to do, at most `at_most`, and does it. Returns false once the
    /// server has stopped.
    bool step(std::chrono::milliseconds at_most);

private:
    struct Peer {
        int socket;
        busbar::server::Connection connection;
        /// The peer has closed the connection, or it broke.
        bool is_gone;
    };

    [[nodiscard]] int time_to_wait(std::chrono::milliseconds at_most) const;
    void accept_one(busbar::TimePoint now);
    void receive(Peer& peer, busbar::TimePoint now);
    /// Sends what waits; false if the connection is over.
    [[nodiscard]] bool send(Peer& peer);

    busbar::server::Server& server_;
    int listener_{-1};
    std::list<Peer> peers_;
};

} // namespace poll_server

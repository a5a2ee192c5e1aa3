#pragma once

#include <chrono>
#include <cstdint>
#include <list>

#include <busbar/server/server.hpp>

namespace poll_server {

/// A loop of one's own around a Server: sockets of the operating system and poll(), no further
/// library, no thread, no exception. What it does with server and connections is all that any loop
/// has to do; another system's sockets take the place of these.
///
/// The server's sources answer at once and nobody calls its Waker; a loop for others makes a
/// descriptor readable there, and calls handle_completions() then.
class PollLoop {
public:
    /// `server` must outlive the loop.
    explicit PollLoop(busbar::server::Server& server) : server_{server} {}
    PollLoop(const PollLoop&) = delete;
    PollLoop& operator=(const PollLoop&) = delete;
    ~PollLoop();

    /// On every address of the machine; false if the port cannot be had.
    [[nodiscard]] bool listen(std::uint16_t port);
    /// Waits until there is something to do, for that long at most, and does it. False once the
    /// server has stopped.
    bool step(std::chrono::milliseconds at_most);

private:
    struct Peer {
        int socket;
        busbar::server::Connection connection;
        /// The peer has closed it, or it broke.
        bool is_gone;
    };

    [[nodiscard]] int time_to_wait(std::chrono::milliseconds at_most) const;
    void accept_one(busbar::TimePoint now);
    void receive(Peer& peer, busbar::TimePoint now);
    /// Sends what waits; false if the connection is done with.
    [[nodiscard]] bool send(Peer& peer);

    busbar::server::Server& server_;
    int listener_{-1};
    std::list<Peer> peers_;
};

} // namespace poll_server

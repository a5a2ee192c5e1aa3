#pragma once

#include <busbar/core/api.hpp>

namespace busbar {

/// Tells the program that drives a server that there is work which no socket and no deadline
/// announces.
class BUSBAR_API Waker {
public:
    Waker() = default;
    Waker(const Waker&) = delete;
    Waker& operator=(const Waker&) = delete;
    virtual ~Waker() = default;

    /// Makes the server's thread call Server::handle_completions soon. Called from any thread,
    /// real-time threads included: it must neither block nor allocate nor call into the server.
    virtual void wake() = 0;
};

} // namespace busbar

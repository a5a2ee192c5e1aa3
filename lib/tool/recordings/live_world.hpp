#pragma once

#include <string>

#include <busbar/harness_net/real_world.hpp>

#include "tool/connection/context.hpp"

namespace busbar::tool {

/// A world that serves real peers until Ctrl+C, or for a time. One at a time.
class LiveWorld {
public:
    LiveWorld();
    LiveWorld(const LiveWorld&) = delete;
    LiveWorld& operator=(const LiveWorld&) = delete;
    ~LiveWorld();

    [[nodiscard]] harness::RealWorld& world() { return world_; }
    /// Opens a socket at "[ADDRESS:]PORT", by default on this machine only; returns its URL, or
    /// throws Failure.
    [[nodiscard]] std::string open(const std::string& address);
    /// Calls `look` several times a second until it is over. 0 seconds are for ever.
    template <typename Look>
    void run(double seconds, Look look)
    {
        using namespace std::chrono_literals;
        const TimePoint begin = world_.now();
        while (!is_interrupted() &&
               (seconds <= 0 || world_.now() - begin < std::chrono::duration<double>{seconds})) {
            world_.run_for(50ms);
            look();
        }
    }

private:
    [[nodiscard]] static bool is_interrupted();

    harness::RealWorld world_;
};

} // namespace busbar::tool

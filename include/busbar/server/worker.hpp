#pragma once

#include <functional>

#include <busbar/core/api.hpp>

namespace busbar::server {

/// Does slow work outside the server's thread.
class BUSBAR_API Worker {
public:
    Worker() = default;
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;
    virtual ~Worker() = default;

    /// Runs `job` once, later and on another thread; false if there is no room for it. Called on
    /// the server's thread; must neither block nor run the job itself.
    [[nodiscard]] virtual bool run(std::function<void()> job) = 0;
};

} // namespace busbar::server

#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace busbar::product {

/// Calls a function at once and then repeatedly, in a thread of its own, so that it may wait for
/// media.
class Ticker {
public:
    using Tick = std::function<std::chrono::milliseconds()>;

    /// `tick` returns the pause before the next call, and must not throw.
    explicit Ticker(Tick tick);
    Ticker(const Ticker&) = delete;
    Ticker& operator=(const Ticker&) = delete;
    /// Waits for a running call.
    ~Ticker();

private:
    void work();

    Tick tick_;
    std::mutex mutex_; // guards the two below
    std::condition_variable ends_;
    bool is_ending_{false};
    std::thread thread_;
};

} // namespace busbar::product

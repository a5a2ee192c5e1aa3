#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace busbar::product {

/// Calls something at once and then again and again, in a thread of its own: it may wait for media.
class Ticker {
public:
    using Tick = std::function<std::chrono::milliseconds()>;

    /// `tick` gives the pause until it is called again, and must not throw.
    explicit Ticker(Tick tick);
    Ticker(const Ticker&) = delete;
    Ticker& operator=(const Ticker&) = delete;
    /// Waits for the call that runs.
    ~Ticker();

private:
    void work();

    Tick tick_;
    std::mutex mutex_; // of the two below
    std::condition_variable ends_;
    bool is_ending_{false};
    std::thread thread_;
};

} // namespace busbar::product

#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace busbar::example {

/// Calls something at once and then once in each period, in a thread of its own.
class Ticker {
public:
    /// `tick` must not throw.
    Ticker(std::chrono::seconds period, std::function<void()> tick);
    Ticker(const Ticker&) = delete;
    Ticker& operator=(const Ticker&) = delete;
    /// Waits for the call that runs.
    ~Ticker();

private:
    void work();

    std::chrono::seconds period_;
    std::function<void()> tick_;
    std::mutex mutex_; // of the two below
    std::condition_variable ends_;
    bool is_ending_{false};
    std::thread thread_;
};

} // namespace busbar::example

#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace busbar::product {

/// Calls a function at once and then repeatedly, in a thread of its own, so that it may wait for
/// media.
class Ticker {
public:
    using Tick = std::function<std::chrono::milliseconds()>;

    /// `tick` returns the pause before the next call, and must not throw.
    explicit Ticker(Tick tick) : tick_{std::move(tick)}, thread_{[this] { work(); }} {}
    Ticker(const Ticker&) = delete;
    Ticker& operator=(const Ticker&) = delete;
    /// Waits for a running call.
    ~Ticker()
    {
        {
            const std::lock_guard lock{mutex_};
            is_ending_ = true;
        }
        ends_.notify_all();
        thread_.join();
    }

private:
    void work()
    {
        std::unique_lock lock{mutex_};
        while (!is_ending_) {
            lock.unlock();
            const std::chrono::milliseconds pause = tick_();
            lock.lock();
            ends_.wait_for(lock, pause, [this] { return is_ending_; });
        }
    }

    Tick tick_;
    std::mutex mutex_; // guards the two below
    std::condition_variable ends_;
    bool is_ending_{false};
    std::thread thread_;
};

} // namespace busbar::product

#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace busbar::controller {

/// Makes threads with the priority that the first caller of instance() had. Thread-safe.
class ThreadMaker {
public:
    static ThreadMaker& instance();
    ThreadMaker(const ThreadMaker&) = delete;
    ThreadMaker& operator=(const ThreadMaker&) = delete;
    ~ThreadMaker();

    /// Throws the exceptions of std::thread.
    [[nodiscard]] std::thread make(std::function<void()> body);

private:
    ThreadMaker() : thread_{[this] { run(); }} {}
    void run();

    std::mutex mutex_;
    std::condition_variable changed_;
    /// The job to start; empty between jobs.
    std::function<void()> job_;
    bool is_over_{false};
    std::thread thread_;
};

} // namespace busbar::controller

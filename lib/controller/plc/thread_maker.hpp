#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace busbar::controller {

/// Makes threads that have the priority which the first caller of instance() had. Any thread.
class ThreadMaker {
public:
    static ThreadMaker& instance();
    ThreadMaker(const ThreadMaker&) = delete;
    ThreadMaker& operator=(const ThreadMaker&) = delete;
    ~ThreadMaker();

    /// Throws what std::thread does.
    [[nodiscard]] std::thread make(std::function<void()> body);

private:
    ThreadMaker() : thread_{[this] { run(); }} {}
    void run();

    std::mutex mutex_;
    std::condition_variable changed_;
    /// One at a time: empty between two of them.
    std::function<void()> job_;
    bool is_over_{false};
    std::thread thread_;
};

} // namespace busbar::controller

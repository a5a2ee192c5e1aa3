#include <busbar/controller/plc_task.hpp>

#include <exception>
#include <utility>

namespace busbar::controller {

ThreadMaker::~ThreadMaker()
{
    {
        const std::lock_guard lock{mutex_};
        is_over_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

std::thread ThreadMaker::make(std::function<void()> body)
{
    std::thread made;
    std::exception_ptr failure;
    bool is_done = false;
    std::unique_lock lock{mutex_};
    changed_.wait(lock, [this] { return !job_; });
    job_ = [&] {
        try {
            made = std::thread{std::move(body)};
        } catch (...) {
            failure = std::current_exception();
        }
        is_done = true;
    };
    changed_.notify_all();
    changed_.wait(lock, [&] { return is_done; });
    if (failure) {
        std::rethrow_exception(failure);
    }
    return made;
}

void ThreadMaker::run()
{
    std::unique_lock lock{mutex_};
    for (;;) {
        changed_.wait(lock, [this] { return is_over_ || job_; });
        if (is_over_) {
            return;
        }
        job_();
        job_ = nullptr;
        changed_.notify_all();
    }
}

} // namespace busbar::controller

#include <busbar/net/worker_thread.hpp>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::net {

struct WorkerThread::Impl {
    Impl(std::size_t most, LogSink* l)
        : log{l != nullptr ? l : &no_log}, max_jobs{most}, thread{[this] { work(); }}
    {
    }

    void work()
    {
        std::unique_lock lock{mutex};
        while (true) {
            changed.wait(lock, [this] { return is_stopping || !jobs.empty(); });
            if (is_stopping) {
                return;
            }
            auto job = std::move(jobs.front());
            jobs.pop_front();
            lock.unlock();
            // The next job runs, whatever this one does.
            busbar::detail::guarded(*log, "job of a WorkerThread", job);
            job = nullptr; // destroys its objects here, and not under the lock
            lock.lock();
        }
    }

    NullLog no_log;
    LogSink* log;
    std::size_t max_jobs;
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<std::function<void()>> jobs;
    bool is_stopping{false};
    std::thread thread; // last, since it uses the others
};

WorkerThread::WorkerThread(std::size_t max_jobs, LogSink* log)
    : impl_{std::make_unique<Impl>(max_jobs, log)}
{
}

WorkerThread::~WorkerThread()
{
    {
        const std::lock_guard lock{impl_->mutex};
        impl_->is_stopping = true;
    }
    impl_->changed.notify_one();
    impl_->thread.join();
}

bool WorkerThread::run(std::function<void()> job)
{
    {
        const std::lock_guard lock{impl_->mutex};
        if (impl_->jobs.size() >= impl_->max_jobs) {
            return false;
        }
        impl_->jobs.push_back(std::move(job));
    }
    impl_->changed.notify_one();
    return true;
}

} // namespace busbar::net

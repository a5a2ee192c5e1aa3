#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <variant>

#include <busbar/backend/device.hpp>
#include <busbar/net/bus_source.hpp>

namespace busbar::net::detail {

/// Makes the calls of a Bus on a thread of its own, in the order in which they are given to it.
class BusThread {
public:
    /// Waits until this time.
    struct Pause {
        TimePoint until;
    };
    /// Opens the connection.
    struct Open {};
    using Job = std::variant<Pause, Open, backend::PlanRequest>;

    /// The pause is over.
    struct Paused {};
    struct Opened {
        Result<void> result;
    };
    struct Answered {
        backend::DeviceAnswer answer;
        bool is_lost{false};
    };
    using Outcome = std::variant<Paused, Opened, Answered>;

    /// `log` must outlive the object, and is called by the thread, too.
    BusThread(std::unique_ptr<Bus> bus, LogSink& log);
    BusThread(const BusThread&) = delete;
    BusThread& operator=(const BusThread&) = delete;
    /// Waits for the call that is under way, and drops the jobs that follow.
    ~BusThread();

    /// Is woken for each outcome; null for none. The one before is not used any more then. What it
    /// throws is discarded.
    void set_waker(Waker* waker);
    /// Fails as std::bad_alloc, with nothing given.
    void give(Job job);
    /// Returns the outcome of the oldest job that is done, and nothing if there is none. The next
    /// job begins then at the earliest, so that the thread needs no memory for outcomes.
    [[nodiscard]] std::optional<Outcome> take();

private:
    void run();
    void wake();
    [[nodiscard]] Outcome outcome_of(const Open& open);
    [[nodiscard]] Outcome outcome_of(const backend::PlanRequest& request);

    std::unique_ptr<Bus> bus_;
    LogSink* log_;
    std::mutex mutex_;
    std::condition_variable changed_;
    Waker* waker_{nullptr};
    std::deque<Job> jobs_;
    std::optional<Outcome> outcome_;
    bool ends_{false};
    std::thread thread_; // last, since it uses the others
};

} // namespace busbar::net::detail

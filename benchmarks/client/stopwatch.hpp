#pragma once

#include <ctime>

#include <busbar/core/clock.hpp>

namespace busbar::bench {

/// Processor time of this thread, which a busy machine does not lengthen.
class Stopwatch {
public:
    template <typename Function>
    void time(Function&& function)
    {
        const Duration begin = now();
        function();
        spent_ += now() - begin;
    }
    void reset() { spent_ = {}; }
    void add(const Stopwatch& other) { spent_ += other.spent_; }
    [[nodiscard]] double seconds() const { return std::chrono::duration<double>{spent_}.count(); }

private:
    [[nodiscard]] static Duration now()
    {
        timespec time{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return std::chrono::seconds{time.tv_sec} + std::chrono::nanoseconds{time.tv_nsec};
    }

    Duration spent_{0};
};

} // namespace busbar::bench

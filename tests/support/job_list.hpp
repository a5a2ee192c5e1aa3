#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <utility>

#include <busbar/server/waker.hpp>
#include <busbar/server/worker.hpp>

namespace busbar::test {

/// Does its jobs when the test says so.
class JobList final : public server::Worker {
public:
    [[nodiscard]] bool run(std::function<void()> job) override
    {
        if (jobs.size() >= most) {
            return false;
        }
        jobs.push_back(std::move(job));
        return true;
    }
    /// False if there is nothing to do.
    bool work_once()
    {
        if (jobs.empty()) {
            return false;
        }
        const auto job = std::move(jobs.front());
        jobs.pop_front();
        job();
        return true;
    }

    std::deque<std::function<void()>> jobs;
    std::size_t most{64};
};

class SilentWaker final : public server::Waker {
public:
    void wake() override {}
};

} // namespace busbar::test

#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/server/worker.hpp>

namespace busbar::net {

/// One thread that does slow work, such as checking passwords or the asymmetric work of channels,
/// one job after the other, so that a login never delays the server.
class BUSBAR_API WorkerThread final : public server::Worker {
public:
    /// At most `max_jobs` wait; more are refused. `log`, which may be null and must outlive this
    /// object, gets the exceptions of jobs.
    explicit WorkerThread(std::size_t max_jobs = 64, LogSink* log = nullptr);
    /// Finishes the running job, and drops those that wait.
    ~WorkerThread() override;

    /// Called from any thread. An exception of a job ends only that job.
    [[nodiscard]] bool run(std::function<void()> job) override;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::net

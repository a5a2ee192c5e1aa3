#pragma once

#include <string>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/worker.hpp>

#include "work_queue.hpp"

namespace busbar::server::detail {

/// A name and a password on their way through a UserStore.
struct PasswordCheck final : WorkItem {
    std::string name;
    crypto::Secret password;
    /// False for a stand-in: the login fails, whatever the store answers.
    bool is_readable{false};
    Result<UserIdentity> result{fail(status::Bad_UserAccessDenied)};
    /// The store that a worker calls; outlives it.
    UserStore* users{nullptr};

    /// The exception of log_in, if it threw; not empty then.
    busbar::detail::ThrownText thrown{};

    /// Calls the store; takes some time.
    void run(UserStore& from);
    void run() override { run(*users); }
};

/// Waits for the end of any check; lives on the server's thread.
class CheckWaiter {
public:
    CheckWaiter() = default;
    CheckWaiter(const CheckWaiter&) = delete;
    CheckWaiter& operator=(const CheckWaiter&) = delete;

    virtual void check_ended(TimePoint now) = 0;

protected:
    ~CheckWaiter() = default;
};

/// Password checks that workers do; those from sources where a login has succeeded before come
/// first. Lives on the server's thread.
class PasswordChecks : public WorkQueue {
public:
    using WorkQueue::WorkQueue;

    /// Returns the worker of the store; null if it has none, or cannot report back.
    [[nodiscard]] Worker* worker_for(UserStore& users) const;

    /// Notifies `waiter` once, when checks have ended; those that have waited longest first. It
    /// must be valid until then, or until stop_waiting.
    void wait(CheckWaiter& waiter) { waiters_.push_back(&waiter); }
    void stop_waiting(CheckWaiter& waiter) { std::erase(waiters_, &waiter); }
    /// Notifies the owners of finished checks, then the waiters.
    void drain(TimePoint now);

private:
    std::vector<CheckWaiter*> waiters_;
};

} // namespace busbar::server::detail

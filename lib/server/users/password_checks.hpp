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
    /// False for a stand-in: whatever the store says, the login fails.
    bool is_readable{false};
    Result<UserIdentity> result{fail(status::Bad_UserAccessDenied)};
    /// Which a worker asks; outlives it.
    UserStore* users{nullptr};

    /// What log_in threw, if it did; not empty then.
    busbar::detail::ThrownText thrown{};

    /// Asks the store; takes its time.
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

/// Password checks that workers do, those first that come from where somebody has logged in before.
/// Lives on the server's thread.
class PasswordChecks : public WorkQueue {
public:
    using WorkQueue::WorkQueue;

    /// The worker of the store; null if it has none, or there is no way back from it.
    [[nodiscard]] Worker* worker_for(UserStore& users) const;

    /// Tells `waiter` once, when checks have ended; those that have waited longest first. It must
    /// be valid until then, or until stop_waiting.
    void wait(CheckWaiter& waiter) { waiters_.push_back(&waiter); }
    void stop_waiting(CheckWaiter& waiter) { std::erase(waiters_, &waiter); }
    /// Tells the owners of what is done, then those who wait for that.
    void drain(TimePoint now);

private:
    std::vector<CheckWaiter*> waiters_;
};

} // namespace busbar::server::detail

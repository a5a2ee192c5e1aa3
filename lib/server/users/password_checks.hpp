#pragma once

#include <atomic>
#include <string>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/worker.hpp>

#include "login_guard.hpp"
#include "work_queue.hpp"

namespace busbar::server::detail {

/// A name and a password on their way through a UserStore.
///
/// The LoginGuard counts a check that a worker does until it ends, which outlives a login whose
/// client goes away: what was compared and wrong is a failure even then, what was right or not
/// looked at is none. So a guess costs the same whether its answer is awaited or not, and a client
/// that is cut off in the middle of right logins is not locked out.
struct PasswordCheck final : WorkItem, private WorkOwner {
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
    void run() override
    {
        if (is_wanted_) {
            run(*users);
        }
    }

    // The following members are called on the server's thread.

    /// The guard, which must outlive the check, counts it from now on. Returns the delay of the
    /// answer if the password is wrong.
    [[nodiscard]] Duration begin(LoginGuard& guard, const LoginAttempt& attempt, TimePoint now);
    /// Tells the guard how it ended, if it was begun and has not ended before.
    void end(LoginGuard::End how);
    /// Ends it by its result: a right password counts as not looked at, since nothing logs in.
    void end_by_result();
    /// Its owner no longer waits: a worker that has not begun compares nothing.
    void leave();

private:
    void work_done(TimePoint /*now*/) override
    {
        busbar::detail::attempt([&] { end_by_result(); });
    }
    void work_displaced(TimePoint /*now*/) override
    {
        busbar::detail::attempt([&] { end(LoginGuard::End::NotLookedAt); });
    }

    std::atomic<bool> is_wanted_{true};
    bool was_compared_{false};
    LoginGuard* guard_{nullptr};
    /// The names that the attempt counts for, and the time at which it began.
    LoginGuard::Names names_;
    TimePoint since_;
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

#include "password_checks.hpp"

#include <cstddef>
#include <utility>

namespace busbar::server::detail {

void PasswordCheck::run(UserStore& from)
{
    was_compared_ = true;
    const StatusCode status =
        busbar::detail::caught(thrown, [&] { result = from.log_in(name, password.text()); });
    if (status.is_bad()) {
        result = fail(status);
        if (thrown.view().empty()) {
            thrown.set("an exception");
        }
    }
}

Duration PasswordCheck::begin(LoginGuard& guard, const LoginAttempt& attempt, TimePoint now)
{
    names_ = LoginGuard::names_of(attempt);
    since_ = now;
    const Duration delay = guard.begun(names_, now);
    guard_ = &guard;
    return delay;
}

void PasswordCheck::end(LoginGuard::End how)
{
    if (LoginGuard* const guard = std::exchange(guard_, nullptr)) {
        guard->ended(names_, how, since_);
    }
}

void PasswordCheck::end_by_result()
{
    // An exception means nothing about the password.
    const bool is_wrong = was_compared_ && thrown.view().empty() && (!is_readable || !result);
    end(is_wrong ? LoginGuard::End::Wrong : LoginGuard::End::NotLookedAt);
}

void PasswordCheck::leave()
{
    is_wanted_ = false;
    owner = this;
}

void PasswordChecks::drain(TimePoint now)
{
    if (!WorkQueue::drain(now)) {
        return;
    }
    // A notified waiter may wait again, and others may give up meanwhile.
    for (std::size_t left = waiters_.size(); left != 0 && !waiters_.empty(); --left) {
        CheckWaiter* const first = waiters_.front();
        waiters_.erase(waiters_.begin());
        first->check_ended(now);
    }
}

Worker* PasswordChecks::worker_for(UserStore& users) const
{
    return has_way_back() ? users.worker() : nullptr;
}

} // namespace busbar::server::detail

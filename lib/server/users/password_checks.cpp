#include "password_checks.hpp"

#include <cstddef>

namespace busbar::server::detail {

void PasswordCheck::run(UserStore& from)
{
    const StatusCode status =
        busbar::detail::caught(thrown, [&] { result = from.log_in(name, password.text()); });
    if (status.is_bad()) {
        result = fail(status);
        if (thrown.view().empty()) {
            thrown.set("an exception");
        }
    }
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

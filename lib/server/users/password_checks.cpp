#include "password_checks.hpp"

#include <utility>

namespace busbar::server::detail {

PasswordChecks::PasswordChecks(Waker* waker) : done_{std::make_shared<Done>()}
{
    done_->waker = waker;
}

PasswordChecks::~PasswordChecks()
{
    const std::lock_guard lock{done_->mutex};
    done_->waker = nullptr;
}

Worker* PasswordChecks::worker_for(UserStore& users) const
{
    return done_->waker != nullptr ? users.worker() : nullptr;
}

bool PasswordChecks::start(const std::shared_ptr<PasswordCheck>& check, Worker& worker,
                           UserStore& users)
{
    return worker.run([check, &users, done = done_] {
        check->run(users);
        done->push(check);
    });
}

void PasswordChecks::Done::push(std::shared_ptr<PasswordCheck> check)
{
    const std::lock_guard lock{mutex};
    checks.push_back(std::move(check));
    if (waker != nullptr) {
        waker->wake();
    }
}

void PasswordChecks::drain(TimePoint now)
{
    std::vector<std::shared_ptr<PasswordCheck>> checks;
    {
        const std::lock_guard lock{done_->mutex};
        checks = std::exchange(done_->checks, {});
    }
    for (const auto& check : checks) {
        if (check->owner != nullptr) {
            check->owner->password_checked(now);
        }
    }
}

} // namespace busbar::server::detail

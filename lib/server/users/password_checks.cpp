#include "password_checks.hpp"

#include <algorithm>
#include <iterator>
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

bool PasswordChecks::start(const std::shared_ptr<PasswordCheck>& check, UserStore& users,
                           FunctionRef<bool(std::function<void()>)> run, TimePoint now)
{
    {
        const std::lock_guard lock{done_->mutex};
        done_->waiting.push_back(check);
    }
    if (run([&users, done = done_] { done->work(users); })) {
        return true;
    }
    // One more waits than there are jobs, whatever was begun meanwhile.
    std::shared_ptr<PasswordCheck> greediest;
    {
        const std::lock_guard lock{done_->mutex};
        greediest = done_->take_greediest();
    }
    if (greediest != check && greediest->owner != nullptr) {
        greediest->owner->password_displaced(now);
    }
    return greediest != check;
}

std::size_t PasswordChecks::Done::count_from(const PasswordCheck& check) const
{
    return static_cast<std::size_t>(std::count_if(
        waiting.begin(), waiting.end(), [&](const Check& c) { return c->source == check.source; }));
}

PasswordChecks::Done::Check PasswordChecks::Done::take_next()
{
    constexpr unsigned most_in_turn = 3;
    const bool has_strangers = std::any_of(waiting.begin(), waiting.end(),
                                           [](const Check& check) { return !check->is_known; });
    const bool is_strangers_turn = has_strangers && known_in_turn >= most_in_turn;
    const auto order = [&](const Check& check) {
        return std::pair{check->is_known == is_strangers_turn, count_from(*check)};
    };
    const auto next =
        std::min_element(waiting.begin(), waiting.end(),
                         [&](const Check& a, const Check& b) { return order(a) < order(b); });
    if (next == waiting.end()) {
        return nullptr;
    }
    Check taken = std::move(*next);
    waiting.erase(next);
    known_in_turn = taken->is_known && has_strangers ? known_in_turn + 1 : 0;
    return taken;
}

PasswordChecks::Done::Check PasswordChecks::Done::take_greediest()
{
    const auto order = [&](const Check& check) {
        return std::pair{!check->is_known, count_from(*check)};
    };
    const auto most =
        std::max_element(waiting.rbegin(), waiting.rend(), // the first of equals: the newest
                         [&](const Check& a, const Check& b) { return order(a) < order(b); });
    Check taken = std::move(*most);
    waiting.erase(std::next(most).base());
    return taken;
}

void PasswordChecks::Done::work(UserStore& users)
{
    Check check;
    {
        const std::lock_guard lock{mutex};
        check = take_next();
    }
    if (check == nullptr) {
        return;
    }
    check->run(users);
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

#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/waker.hpp>
#include <busbar/server/worker.hpp>

namespace busbar::server::detail {

/// Who waits for a password check; lives on the server's thread.
class PasswordCheckOwner {
public:
    PasswordCheckOwner() = default;
    PasswordCheckOwner(const PasswordCheckOwner&) = delete;
    PasswordCheckOwner& operator=(const PasswordCheckOwner&) = delete;

    virtual void password_checked(TimePoint now) = 0;
    /// It will not be looked at: others, who have asked for less, took its place.
    virtual void password_displaced(TimePoint now) = 0;

protected:
    ~PasswordCheckOwner() = default;
};

/// A name and a password on their way through a UserStore.
struct PasswordCheck {
    std::string name;
    crypto::Secret password;
    /// False for a stand-in: whatever the store says, the login fails.
    bool is_readable{false};
    /// Where it comes from (see LoginGuard::source_of), and that somebody has logged in from there.
    std::string source{};
    bool is_known{false};
    Result<UserIdentity> result{fail(status::Bad_UserAccessDenied)};
    /// Only touched on the server's thread; null if nobody waits any more.
    PasswordCheckOwner* owner{nullptr};

    /// What log_in threw, if it did.
    std::string thrown{};

    /// Asks the store; takes its time.
    void run(UserStore& users)
    {
        const StatusCode status =
            busbar::detail::caught(thrown, [&] { result = users.log_in(name, password.text()); });
        if (status.is_bad()) {
            result = fail(status);
            thrown = thrown.empty() ? "an exception" : thrown;
        }
    }
};

/// Password checks that workers do. Lives on the server's thread.
///
/// The worker decides how many wait, these which is next: what comes from where somebody has logged
/// in before strangers', though every fourth is a stranger's; of either the sources that have
/// fewest waiting before the others. When there is no room for one more, the last of the stranger
/// who has most waiting goes.
class PasswordChecks {
public:
    /// `waker` may be null; it must be valid as long as this.
    explicit PasswordChecks(Waker* waker);
    PasswordChecks(const PasswordChecks&) = delete;
    PasswordChecks& operator=(const PasswordChecks&) = delete;
    ~PasswordChecks();

    /// The worker of the store; null if it has none, or there is no way back from it.
    [[nodiscard]] Worker* worker_for(UserStore& users) const;
    /// Has a worker ask the store by `run`, which is Worker::run; the check's owner is told later.
    /// False if there is no room and nobody else has more waiting.
    [[nodiscard]] bool start(const std::shared_ptr<PasswordCheck>& check, UserStore& users,
                             FunctionRef<bool(std::function<void()>)> run, TimePoint now);
    /// Tells the owners of checks that are done.
    void drain(TimePoint now);

private:
    /// Outlives the server if a worker is late.
    struct Done {
        using Check = std::shared_ptr<PasswordCheck>;
        using Checks = std::vector<Check>;

        void work(UserStore& users);
        /// Takes out what is to be looked at next; null if nothing waits.
        [[nodiscard]] Check take_next();
        /// Takes out what is not to be looked at.
        [[nodiscard]] Check take_greediest();
        [[nodiscard]] std::size_t count_from(const PasswordCheck& check) const;

        std::mutex mutex;
        Waker* waker;
        /// The oldest first, one for each job that the worker has not begun.
        Checks waiting;
        /// Those that had their turn while strangers waited.
        unsigned known_in_turn{0};
        Checks checks;
    };
    std::shared_ptr<Done> done_;
};

} // namespace busbar::server::detail

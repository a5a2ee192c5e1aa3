#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/core/detail/guarded.hpp>
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

protected:
    ~PasswordCheckOwner() = default;
};

/// A name and a password on their way through a UserStore.
struct PasswordCheck {
    std::string name;
    crypto::Secret password;
    /// False for a stand-in: whatever the store says, the login fails.
    bool is_readable{false};
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
class PasswordChecks {
public:
    /// `waker` may be null; it must be valid as long as this.
    explicit PasswordChecks(Waker* waker);
    PasswordChecks(const PasswordChecks&) = delete;
    PasswordChecks& operator=(const PasswordChecks&) = delete;
    ~PasswordChecks();

    /// The worker of the store; null if it has none, or there is no way back from it.
    [[nodiscard]] Worker* worker_for(UserStore& users) const;
    /// Has `worker` ask the store; the check's owner is told later. False if the worker is full.
    [[nodiscard]] bool start(const std::shared_ptr<PasswordCheck>& check, Worker& worker,
                             UserStore& users);
    /// Tells the owners of checks that are done.
    void drain(TimePoint now);

private:
    /// Outlives the server if a worker is late.
    struct Done {
        void push(std::shared_ptr<PasswordCheck> check);

        std::mutex mutex;
        Waker* waker;
        std::vector<std::shared_ptr<PasswordCheck>> checks;
    };
    std::shared_ptr<Done> done_;
};

} // namespace busbar::server::detail

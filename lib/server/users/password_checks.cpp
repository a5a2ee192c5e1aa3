#include "password_checks.hpp"

#include <utility>

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

Worker* PasswordChecks::worker_for(UserStore& users) const
{
    return has_way_back() ? users.worker() : nullptr;
}

} // namespace busbar::server::detail

#include "login_guard.hpp"

#include <algorithm>

namespace busbar::server::detail {

const LoginGuard::Entry* LoginGuard::find(std::string_view client) const
{
    const auto found = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const Entry& e) { return e.client == client; });
    return found == entries_.end() ? nullptr : &*found;
}

LoginGuard::Entry& LoginGuard::entry(std::string_view client)
{
    if (const Entry* known = find(client)) {
        return const_cast<Entry&>(*known);
    }
    if (entries_.size() < std::max<std::size_t>(limits_->max_login_entries, 1)) {
        return entries_.emplace_back(Entry{std::string{client}, 0, {}});
    }
    Entry& oldest =
        *std::min_element(entries_.begin(), entries_.end(),
                          [](const Entry& a, const Entry& b) { return a.last < b.last; });
    oldest = {std::string{client}, 0, {}};
    return oldest;
}

bool LoginGuard::is_locked(std::string_view client, TimePoint now) const
{
    const Entry* known = find(client);
    return known != nullptr && known->failures >= limits_->max_login_failures &&
           now < known->last + limits_->login_lock;
}

Duration LoginGuard::failed(std::string_view client, TimePoint now)
{
    Entry& known = entry(client);
    if (now >= known.last + limits_->login_lock) {
        known.failures = 0; // what was long ago is forgiven
    }
    if (!is_locked(client, now)) {
        known.last = now; // a lock does not grow by trying
    }
    known.failures = std::min(known.failures + 1, std::size_t{64});
    // A single mistake is not punished.
    if (known.failures < 2) {
        return Duration::zero();
    }
    const std::size_t doublings = std::min<std::size_t>(known.failures - 2, 16);
    return std::min<Duration>(Duration{limits_->first_login_delay} * (1 << doublings),
                              limits_->max_login_delay);
}

void LoginGuard::succeeded(std::string_view client)
{
    std::erase_if(entries_, [&](const Entry& e) { return e.client == client; });
}

} // namespace busbar::server::detail

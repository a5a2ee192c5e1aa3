#include "login_guard.hpp"

#include <algorithm>

namespace busbar::server::detail {

namespace {

/// Longer names are counted as if they ended here.
constexpr std::size_t max_name_size = 128;
/// Names that one source is counted for separately.
constexpr std::size_t max_users_per_source = 8;
/// Sources that one user is remembered at.
constexpr std::size_t max_sources_per_user = 8;

std::string_view cut(std::string_view name)
{
    return name.substr(0, max_name_size);
}

} // namespace

bool LoginGuard::is_forgiven(const Count& count, TimePoint now) const
{
    return now >= count.last + limits_->login_lock;
}

template <typename Entry>
const Entry* LoginGuard::find(const std::vector<Entry>& table, std::string_view name,
                              TimePoint now) const
{
    const auto found = std::find_if(table.begin(), table.end(), [&](const Entry& entry) {
        return entry.name == cut(name) && !is_forgiven(entry, now);
    });
    return found == table.end() ? nullptr : &*found;
}

template <typename Entry>
bool LoginGuard::has_place(const std::vector<Entry>& table, std::size_t most, TimePoint now) const
{
    return table.size() < most || std::any_of(table.begin(), table.end(), [&](const Entry& entry) {
               return entry.failures <= 1 || is_forgiven(entry, now);
           });
}

template <typename Entry>
Entry* LoginGuard::count_in(std::vector<Entry>& table, std::string_view name, std::size_t most,
                            TimePoint now) const
{
    std::erase_if(table, [&](const Entry& entry) { return is_forgiven(entry, now); });
    if (const Entry* known = find(table, name, now)) {
        return const_cast<Entry*>(known);
    }
    if (table.size() >= std::max<std::size_t>(most, 1)) {
        const auto least =
            std::min_element(table.begin(), table.end(), [](const Entry& a, const Entry& b) {
                return a.failures != b.failures ? a.failures < b.failures : a.last < b.last;
            });
        if (least->failures > 1) {
            return nullptr;
        }
        table.erase(least);
    }
    Entry& made = table.emplace_back();
    made.name = cut(name);
    return &made;
}

LoginGuard::Names LoginGuard::source_names(const LoginAttempt& attempt)
{
    std::string network = network_of(attempt.address);
    if (attempt.certificate.empty()) {
        return {"address " + network, {}};
    }
    return {"certificate " + std::string{attempt.certificate},
            attempt.has_code ? std::string{} : "certificates from " + network};
}

std::string LoginGuard::source_of(const LoginAttempt& attempt)
{
    return source_names(attempt).first;
}

bool LoginGuard::knows(std::string_view source) const
{
    return std::any_of(known_good_.begin(), known_good_.end(),
                       [&](const Success& success) { return success.source == cut(source); });
}

bool LoginGuard::is_known_good(std::string_view user, std::string_view source) const
{
    return !user.empty() &&
           std::any_of(known_good_.begin(), known_good_.end(), [&](const Success& success) {
               return success.user == cut(user) && success.source == cut(source);
           });
}

bool LoginGuard::is_locked(std::string_view source, std::string_view user, TimePoint now) const
{
    const Source* from = find(sources_, source, now);
    const Count* count = from != nullptr ? find(from->users, user, now) : nullptr;
    return count != nullptr && count->failures >= limits_->max_login_failures;
}

bool LoginGuard::is_source_locked(std::string_view source, TimePoint now) const
{
    const Source* from = find(sources_, source, now);
    return from != nullptr && from->failures >= limits_->max_login_failures_per_source;
}

Duration LoginGuard::delay_after(std::size_t failures) const
{
    // A single mistake is not punished.
    if (failures < 2) {
        return Duration::zero();
    }
    const std::size_t doublings = std::min<std::size_t>(failures - 2, 16);
    return std::min<Duration>(Duration{limits_->first_login_delay} * (1 << doublings),
                              limits_->max_login_delay);
}

Duration LoginGuard::slow_down(const LoginAttempt& attempt, const Names& names, TimePoint now) const
{
    const Source* source = find(sources_, names.first, now);
    const Count* user = find(users_, attempt.user, now);
    const std::size_t most = limits_->max_login_entries;
    if ((source == nullptr && !has_place(sources_, most, now)) ||
        (user == nullptr && !has_place(users_, most, now))) {
        return limits_->max_login_delay;
    }
    const std::size_t failures = user != nullptr ? user->failures : 0;
    return failures > limits_->max_login_failures
               ? delay_after(failures - limits_->max_login_failures + 1)
               : Duration::zero();
}

LoginGuard::Admission LoginGuard::admit(const LoginAttempt& attempt, TimePoint now) const
{
    const Names names = source_names(attempt);
    if (is_locked(names.first, attempt.user, now)) {
        return {true, limits_->max_login_delay};
    }
    if (is_known_good(attempt.user, names.first)) {
        return {};
    }
    if (is_source_locked(names.first, now) || is_source_locked(names.second, now)) {
        return {true, limits_->max_login_delay};
    }
    return {false, slow_down(attempt, names, now)};
}

std::size_t LoginGuard::count_failure(std::string_view source, std::string_view user, TimePoint now)
{
    Source* from = count_in(sources_, source, limits_->max_login_entries, now);
    if (from == nullptr) {
        return limits_->max_login_failures;
    }
    ++from->failures;
    from->last = now;
    if (Count* count = count_in(from->users, user, max_users_per_source, now)) {
        ++count->failures;
        count->last = now;
    }
    return from->failures;
}

Duration LoginGuard::failed(const LoginAttempt& attempt, TimePoint now)
{
    const Names names = source_names(attempt);
    const std::size_t failures = count_failure(names.first, attempt.user, now);
    if (!names.second.empty()) {
        static_cast<void>(count_failure(names.second, attempt.user, now));
    }
    if (!attempt.user.empty()) {
        if (Count* count = count_in(users_, attempt.user, limits_->max_login_entries, now)) {
            ++count->failures;
            count->last = now;
        }
    }
    return delay_after(failures);
}

void LoginGuard::forgive(std::string_view source, std::string_view user)
{
    const auto from = std::find_if(sources_.begin(), sources_.end(),
                                   [&](const Source& s) { return s.name == cut(source); });
    if (from == sources_.end()) {
        return;
    }
    const auto count = std::find_if(from->users.begin(), from->users.end(),
                                    [&](const Count& c) { return c.name == cut(user); });
    if (count != from->users.end()) {
        from->failures -= std::min(from->failures, count->failures);
        from->users.erase(count);
    }
    if (from->failures == 0) {
        sources_.erase(from);
    }
}

void LoginGuard::remember(std::string_view user, std::string_view source)
{
    const auto is_users = [&](const Success& s) { return s.user == cut(user); };
    std::erase_if(known_good_,
                  [&](const Success& s) { return is_users(s) && s.source == cut(source); });
    const auto count = std::count_if(known_good_.begin(), known_good_.end(), is_users);
    if (static_cast<std::size_t>(count) >= max_sources_per_user) {
        known_good_.erase(std::find_if(known_good_.begin(), known_good_.end(), is_users));
    } else if (known_good_.size() >= std::max<std::size_t>(limits_->max_login_entries, 1)) {
        known_good_.erase(known_good_.begin());
    }
    known_good_.push_back({std::string{cut(user)}, std::string{cut(source)}});
}

void LoginGuard::succeeded(const LoginAttempt& attempt, bool was_counted)
{
    const Names names = source_names(attempt);
    for (const std::string& source : {names.first, names.second}) {
        forgive(source, attempt.user);
    }
    if (attempt.user.empty()) {
        return;
    }
    remember(attempt.user, names.first);
    const auto everywhere = std::find_if(users_.begin(), users_.end(), [&](const Count& count) {
        return count.name == cut(attempt.user);
    });
    if (was_counted && everywhere != users_.end() && --everywhere->failures == 0) {
        users_.erase(everywhere);
    }
}

} // namespace busbar::server::detail

#include "login_guard.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

namespace busbar::server::detail {

namespace {

/// Longer names are counted as if they ended here.
constexpr std::size_t max_name_size = 128;
/// Maximum number of names that one source is counted for separately.
constexpr std::size_t max_users_per_source = 8;
/// Maximum number of sources that one user is remembered at.
constexpr std::size_t max_sources_per_user = 8;

std::string_view cut(std::string_view name)
{
    return name.substr(0, max_name_size);
}

/// The table takes `more` entries without memory afterwards.
template <typename Entry>
void make_room(std::vector<Entry>& table, std::size_t more = 1)
{
    if (table.capacity() - table.size() < more) {
        table.reserve(table.size() + std::max(table.size(), more));
    }
}

/// Returns null if there is none, however old it may be.
template <typename Entry>
Entry* named(std::vector<Entry>& table, std::string_view name)
{
    const auto found = std::find_if(table.begin(), table.end(),
                                    [&](const Entry& entry) { return entry.name == cut(name); });
    return found == table.end() ? nullptr : &*found;
}

/// Removes an entry without counts.
template <typename Entry>
void drop_if_empty(std::vector<Entry>& table, std::string_view name)
{
    std::erase_if(table, [&](const Entry& e) { return e.name == cut(name) && e.most() == 0; });
}

template <typename Entry>
void release_check(std::vector<Entry>& table, std::string_view name)
{
    if (Entry* const entry = named(table, name); entry != nullptr && entry->checks != 0) {
        --entry->checks;
        drop_if_empty(table, name);
    }
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
               return entry.most() <= 1 || is_forgiven(entry, now);
           });
}

template <typename Entry>
Entry* LoginGuard::count_in(std::vector<Entry>& table, Entry made, std::string_view name,
                            std::size_t most, TimePoint now) const
{
    std::erase_if(table, [&](const Entry& entry) { return is_forgiven(entry, now); });
    if (Entry* const known = named(table, name)) {
        return known;
    }
    if (made.name != cut(name)) {
        return nullptr; // it has just made room for the attempt's other source
    }
    if (table.size() >= std::max<std::size_t>(most, 1)) {
        const auto least =
            std::min_element(table.begin(), table.end(), [](const Entry& a, const Entry& b) {
                return a.most() != b.most() ? a.most() < b.most() : a.last < b.last;
            });
        if (least->most() > 1) {
            return nullptr;
        }
        table.erase(least);
    }
    return &table.emplace_back(std::move(made));
}

template <typename Entry>
Entry LoginGuard::make_entry(std::vector<Entry>& table, std::string_view name, TimePoint now) const
{
    Entry made;
    if (find(table, name, now) == nullptr) {
        make_room(table);
        made.name = cut(name);
    }
    return made;
}

LoginGuard::Made LoginGuard::make_entries(std::string_view source, std::string_view user,
                                          TimePoint now)
{
    Made made;
    made.source = make_entry(sources_, source, now);
    auto* const known = made.source.name.empty() ? named(sources_, source) : nullptr;
    made.user = make_entry(known != nullptr ? known->users : made.source.users, user, now);
    return made;
}

LoginGuard::Names LoginGuard::names_of(const LoginAttempt& attempt)
{
    std::string user{cut(attempt.user)};
    const std::string network = network_of(attempt.address);
    if (attempt.certificate.empty()) {
        return {"address " + network, {}, std::move(user)};
    }
    return {"certificate " + std::string{attempt.certificate},
            attempt.has_code ? std::string{} : "certificates from " + network, std::move(user)};
}

std::string LoginGuard::source_of(const LoginAttempt& attempt)
{
    return names_of(attempt).first;
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

LoginGuard::Admission LoginGuard::admission(const Count* count, std::size_t most, Duration delay)
{
    if (count == nullptr || count->most() < most) {
        return {};
    }
    const bool is_locked = count->failures >= most;
    return {is_locked, !is_locked, is_locked ? delay : Duration::zero()};
}

LoginGuard::Admission LoginGuard::admit_user(std::string_view source, std::string_view user,
                                             TimePoint now) const
{
    const Source* from = find(sources_, source, now);
    return admission(from != nullptr ? find(from->users, user, now) : nullptr,
                     limits_->max_login_failures, limits_->max_login_delay);
}

LoginGuard::Admission LoginGuard::admit_source(std::string_view source, TimePoint now) const
{
    return admission(find(sources_, source, now), limits_->max_login_failures_per_source,
                     limits_->max_login_delay);
}

Duration LoginGuard::delay_after(std::size_t failures) const
{
    // A single mistake has no consequences.
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
    const auto is_free = [](const Admission& admission) {
        return !admission.is_locked && !admission.has_to_wait;
    };
    const Names names = names_of(attempt);
    const Admission user = admit_user(names.first, attempt.user, now);
    if (!is_free(user) || is_known_good(attempt.user, names.first)) {
        return user;
    }
    const Admission first = admit_source(names.first, now);
    const Admission second = admit_source(names.second, now);
    if (!is_free(first) || !is_free(second)) {
        return first.is_locked || is_free(second) ? first : second;
    }
    return {false, false, slow_down(attempt, names, now)};
}

std::size_t LoginGuard::count_at(std::string_view source, std::string_view user, Made made,
                                 std::size_t Count::*kind, TimePoint now)
{
    Source* from =
        count_in(sources_, std::move(made.source), source, limits_->max_login_entries, now);
    if (from == nullptr) {
        return limits_->max_login_failures;
    }
    ++(from->*kind);
    from->last = std::max(from->last, now);
    if (Count* count =
            count_in(from->users, std::move(made.user), user, max_users_per_source, now)) {
        ++(count->*kind);
        count->last = std::max(count->last, now);
    }
    return from->most();
}

std::size_t LoginGuard::count(const Names& names, std::size_t Count::*kind, TimePoint now)
{
    // All memory first: as far as memory goes, the attempt counts everywhere or nowhere.
    const bool has_second = !names.second.empty();
    const auto is_new = [&](std::string_view name) { return find(sources_, name, now) == nullptr; };
    make_room(sources_,
              std::size_t{is_new(names.first)} + std::size_t{has_second && is_new(names.second)});
    Made first = make_entries(names.first, names.user, now);
    Made second = has_second ? make_entries(names.second, names.user, now) : Made{};
    Count user = names.user.empty() ? Count{} : make_entry(users_, names.user, now);

    const std::size_t failures = count_at(names.first, names.user, std::move(first), kind, now);
    if (has_second) {
        static_cast<void>(count_at(names.second, names.user, std::move(second), kind, now));
    }
    if (!names.user.empty()) {
        if (Count* everywhere =
                count_in(users_, std::move(user), names.user, limits_->max_login_entries, now)) {
            ++(everywhere->*kind);
            everywhere->last = std::max(everywhere->last, now);
        }
    }
    return failures;
}

Duration LoginGuard::failed(const LoginAttempt& attempt, TimePoint now)
{
    return delay_after(count(names_of(attempt), &Count::failures, now));
}

Duration LoginGuard::begun(const Names& names, TimePoint now)
{
    return delay_after(count(names, &Count::checks, now));
}

void LoginGuard::ended(const Names& names, End end, TimePoint now)
{
    // Last, so that a wrong one becomes a failure of entries that are there, without memory.
    const busbar::detail::Undo at_the_end{[&] { release(names); }};
    if (end == End::Wrong) {
        static_cast<void>(count(names, &Count::failures, now));
    } else if (end == End::Right) {
        count_success(names);
    }
}

void LoginGuard::release(const Names& names)
{
    for (const std::string_view name :
         {std::string_view{names.first}, std::string_view{names.second}}) {
        if (Source* const source = named(sources_, name)) {
            release_check(source->users, names.user);
            release_check(sources_, name);
        }
    }
    release_check(users_, names.user);
}

void LoginGuard::forgive(std::string_view name, std::string_view user)
{
    Source* const source = named(sources_, name);
    Count* const count = source != nullptr ? named(source->users, user) : nullptr;
    if (count == nullptr) {
        return;
    }
    source->failures -= std::min(source->failures, count->failures);
    count->failures = 0;
    drop_if_empty(source->users, user);
    drop_if_empty(sources_, name);
}

void LoginGuard::remember(std::string_view user, std::string_view source)
{
    Success made{std::string{cut(user)}, std::string{cut(source)}};
    make_room(known_good_);
    const auto is_users = [&](const Success& s) { return s.user == cut(user); };
    std::erase_if(known_good_,
                  [&](const Success& s) { return is_users(s) && s.source == cut(source); });
    const auto count = std::count_if(known_good_.begin(), known_good_.end(), is_users);
    if (static_cast<std::size_t>(count) >= max_sources_per_user) {
        known_good_.erase(std::find_if(known_good_.begin(), known_good_.end(), is_users));
    } else if (known_good_.size() >= std::max<std::size_t>(limits_->max_login_entries, 1)) {
        known_good_.erase(known_good_.begin());
    }
    known_good_.push_back(std::move(made));
}

void LoginGuard::succeeded(const LoginAttempt& attempt)
{
    count_success(names_of(attempt));
}

void LoginGuard::count_success(const Names& names)
{
    if (!names.user.empty()) {
        remember(names.user, names.first);
    }
    for (const std::string_view source :
         {std::string_view{names.first}, std::string_view{names.second}}) {
        forgive(source, names.user);
    }
}

} // namespace busbar::server::detail

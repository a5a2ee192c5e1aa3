#include <busbar/server/password_users.hpp>

#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include <busbar/core/text.hpp>
#include <busbar/crypto/password_hash.hpp>

#include "stand_in.hpp"

namespace busbar::server {

namespace {

Unexpected<Refusal> refuse_change(StatusCode status, std::string_view name, std::string found)
{
    return refuse(
        {status, "user list", "user \"" + printable(name) + "\" " + std::move(found), {}, {}});
}

} // namespace

struct PasswordUsers::User {
    std::string password_hash;
    UserRights rights;
    bool has_code{false};
};

/// A Change has no use for the mutex.
struct PasswordUsers::Users {
    std::mutex mutex; // protects all
    std::map<std::string, User, std::less<>> all;
};

PasswordUsers::Change::Change() : set_{std::make_unique<Users>()} {}
PasswordUsers::Change::Change(Change&&) noexcept = default;
PasswordUsers::Change& PasswordUsers::Change::operator=(Change&&) noexcept = default;
PasswordUsers::Change::~Change() = default;

PasswordUsers::PasswordUsers(PasswordRules rules)
    : rules_{std::move(rules)}, users_{std::make_unique<Users>()}
{
}
PasswordUsers::~PasswordUsers() = default;

Checked<void> PasswordUsers::add(std::string_view name, std::string_view password,
                                 crypto::Random& random, UserRights rights)
{
    if (auto checked = check_user_name(rules_, name); !checked) {
        return checked;
    }
    if (auto checked = check_password(rules_, name, password); !checked) {
        return checked;
    }
    auto hash = crypto::hash_password(password, random, rules_.cost);
    if (!hash) {
        return refuse_change(hash.error(), name, "has no password hash");
    }
    const std::lock_guard lock{users_->mutex};
    if (users_->all.find(name) != users_->all.end()) {
        return refuse_change(status::Bad_EntryExists, name, "is there already");
    }
    if (users_->all.size() >= rules_.max_users) {
        return refuse_change(status::Bad_TooManyOperations, name, "is one more than there may be");
    }
    users_->all.emplace(std::string{name}, User{*std::move(hash), std::move(rights)});
    return {};
}

Checked<void> PasswordUsers::change_password(std::string_view name, std::string_view old_password,
                                             std::string_view new_password, crypto::Random& random)
{
    if (!log_in(name, old_password)) {
        return refuse_change(status::Bad_UserAccessDenied, name,
                             "is not there or has another password");
    }
    if (auto checked = check_password(rules_, name, new_password); !checked) {
        return checked;
    }
    auto hash = crypto::hash_password(new_password, random, rules_.cost);
    if (!hash) {
        return refuse_change(hash.error(), name, "has no hash for the new password");
    }
    const std::lock_guard lock{users_->mutex};
    const auto found = users_->all.find(name);
    if (found == users_->all.end()) {
        return refuse_change(status::Bad_UserAccessDenied, name, "was removed meanwhile");
    }
    found->second.password_hash = *std::move(hash);
    return {};
}

bool PasswordUsers::remove(std::string_view name)
{
    const std::lock_guard lock{users_->mutex};
    const auto found = users_->all.find(name);
    if (found == users_->all.end()) {
        return false;
    }
    users_->all.erase(found);
    return true;
}

Result<void> PasswordUsers::Change::put(std::string name, User user)
{
    if (name.empty() || !crypto::is_password_hash(user.password_hash)) {
        return fail(status::Bad_InvalidArgument);
    }
    set_->all.insert_or_assign(std::move(name), std::move(user));
    return {};
}

Result<void> PasswordUsers::Change::set(std::string name, std::string password_hash,
                                        UserRights rights)
{
    return put(std::move(name), User{std::move(password_hash), std::move(rights)});
}

Result<void> PasswordUsers::Change::set_code(std::string name, std::string code_hash,
                                             UserRights rights)
{
    return put(std::move(name), User{std::move(code_hash), std::move(rights), true});
}

Result<void> PasswordUsers::set(std::string name, std::string password_hash, UserRights rights)
{
    Change change;
    auto set = change.set(std::move(name), std::move(password_hash), std::move(rights));
    if (set) {
        apply(std::move(change));
    }
    return set;
}

Result<void> PasswordUsers::set_code(std::string name, std::string code_hash, UserRights rights)
{
    Change change;
    auto set = change.set_code(std::move(name), std::move(code_hash), std::move(rights));
    if (set) {
        apply(std::move(change));
    }
    return set;
}

bool PasswordUsers::has_code(std::string_view name) const
{
    const std::lock_guard lock{users_->mutex};
    const auto found = users_->all.find(name);
    return found != users_->all.end() && found->second.has_code;
}

void PasswordUsers::apply(Change change) noexcept
{
    const std::lock_guard lock{users_->mutex};
    for (const std::string& name : change.gone_) {
        users_->all.erase(name);
    }
    change.set_->all.merge(users_->all); // users that are not set again
    users_->all.swap(change.set_->all);
}

std::string PasswordUsers::password_hash(std::string_view name) const
{
    const std::lock_guard lock{users_->mutex};
    const auto found = users_->all.find(name);
    return found != users_->all.end() ? found->second.password_hash : std::string{};
}

Result<UserIdentity> PasswordUsers::log_in(std::string_view name, std::string_view password)
{
    std::optional<UserRights> rights;
    std::string hash;
    {
        const std::lock_guard lock{users_->mutex};
        if (users_->all.empty()) {
            return fail(status::Bad_UserAccessDenied);
        }
        std::vector<std::string_view> hashes;
        hashes.reserve(users_->all.size());
        for (const auto& [other, user] : users_->all) {
            hashes.push_back(user.password_hash);
        }
        // Chosen in any case, so that an unknown name takes as long as a known one.
        hash = hashes[detail::stand_in_for(name, hashes)];
        if (const auto found = users_->all.find(name); found != users_->all.end()) {
            hash = found->second.password_hash;
            rights = found->second.rights;
        }
    }
    const bool is_right = crypto::verify_password(password, hash);
    if (!rights || !is_right) {
        return fail(status::Bad_UserAccessDenied);
    }
    UserIdentity identity{UserTokenType::UserName, std::string{name}, rights->access_level_mask,
                          std::move(rights->roles)};
    identity.must_change_password = rights->must_change_password;
    identity.administers_only = rights->administers_only;
    return identity;
}

UserIdentity PasswordUsers::anonymous() const
{
    return {UserTokenType::Anonymous, {}, anonymous_};
}

} // namespace busbar::server

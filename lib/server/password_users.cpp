#include <busbar/server/access_control.hpp>

#include <busbar/crypto/password_hash.hpp>

namespace busbar::server {

Result<void> PasswordUsers::set(std::string name, std::string password_hash,
                                std::uint8_t access_level_mask)
{
    if (name.empty() || !crypto::is_password_hash(password_hash)) {
        return fail(status::Bad_InvalidArgument);
    }
    users_.insert_or_assign(std::move(name), User{std::move(password_hash), access_level_mask});
    return {};
}

Result<UserIdentity> PasswordUsers::log_in(std::string_view name, std::string_view password)
{
    if (users_.empty()) {
        return fail(status::Bad_UserAccessDenied);
    }
    const auto found = users_.find(name);
    // A name that is not there costs as much time as one that is.
    const User& user = found != users_.end() ? found->second : users_.begin()->second;
    const bool is_right = crypto::verify_password(password, user.password_hash);
    if (found == users_.end() || !is_right) {
        return fail(status::Bad_UserAccessDenied);
    }
    return UserIdentity{UserTokenType::UserName, found->first, user.access_level_mask};
}

UserIdentity PasswordUsers::anonymous() const
{
    return {UserTokenType::Anonymous, {}, anonymous_};
}

} // namespace busbar::server

#include <busbar/server/user_directory.hpp>

#include <algorithm>

namespace busbar::server {

bool is_configure_admin(const UserIdentity& user)
{
    return std::find(user.roles.begin(), user.roles.end(), "ConfigureAdmin") != user.roles.end();
}

void UserDirectory::set_certificate_rights(std::string thumbprint, UserRights rights)
{
    certificate_rights_.insert_or_assign(std::move(thumbprint), std::move(rights));
}

void UserDirectory::set_other_certificate_rights(std::optional<UserRights> rights)
{
    other_certificate_rights_ = std::move(rights);
}

void UserDirectory::set_role_access(std::string role, std::uint8_t access_level_mask)
{
    role_access_.insert_or_assign(std::move(role), access_level_mask);
}

Result<UserIdentity> UserDirectory::log_in(std::string_view name, std::string_view password)
{
    return passwords_.log_in(name, password);
}

Result<UserRights> UserDirectory::certificate_user(const crypto::Certificate& user)
{
    const auto found = certificate_rights_.find(user.thumbprint_text());
    if (found != certificate_rights_.end()) {
        return found->second;
    }
    if (!other_certificate_rights_) {
        return fail(status::Bad_IdentityTokenRejected);
    }
    return *other_certificate_rights_;
}

Result<UserRights> UserDirectory::token_user(const crypto::JwtClaims& claims)
{
    UserRights rights{anonymous_reader().access_level_mask, {}};
    for (const std::string& role : claims.roles) {
        const auto found = role_access_.find(role);
        if (found != role_access_.end()) {
            rights.access_level_mask |= found->second;
            rights.roles.push_back(role);
        }
    }
    return rights;
}

} // namespace busbar::server

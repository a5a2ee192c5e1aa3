#include <busbar/administration/configured_users.hpp>

#include <algorithm>
#include <utility>

namespace busbar::administration {

namespace {

bool has_role(const std::vector<std::string>& roles, std::string_view role)
{
    return std::find(roles.begin(), roles.end(), role) != roles.end();
}

} // namespace

void ConfiguredUsers::replace(std::vector<ConfiguredUser> users,
                              std::vector<std::string> token_roles)
{
    const std::lock_guard lock{mutex_};
    users_ = std::move(users);
    token_roles_ = std::move(token_roles);
}

std::vector<ConfiguredUser> ConfiguredUsers::users() const
{
    const std::lock_guard lock{mutex_};
    return users_;
}

bool ConfiguredUsers::has(std::string_view user) const
{
    const std::lock_guard lock{mutex_};
    return std::any_of(users_.begin(), users_.end(),
                       [&](const ConfiguredUser& each) { return each.name == user; });
}

bool ConfiguredUsers::has_administrator() const
{
    const std::lock_guard lock{mutex_};
    return std::any_of(users_.begin(), users_.end(), [](const ConfiguredUser& each) {
        return !each.is_temporary && has_role(each.roles, "SecurityAdmin");
    });
}

std::vector<IdentityMappingRuleType> ConfiguredUsers::identities_of(std::string_view role) const
{
    std::vector<IdentityMappingRuleType> rules;
    const std::lock_guard lock{mutex_};
    for (const ConfiguredUser& user : users_) {
        if (has_role(user.roles, role)) {
            rules.push_back({IdentityCriteriaType::UserName, String{user.name}});
        }
    }
    if (has_role(token_roles_, role)) {
        rules.push_back({IdentityCriteriaType::Role, String{role}});
    }
    return rules;
}

} // namespace busbar::administration

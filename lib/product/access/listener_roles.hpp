#pragma once

#include <busbar/server/access_control.hpp>

namespace busbar::product {

/// Gives the roles that another mapper gives, and keeps to what the listener is for that somebody
/// has connected to (ListenerUse): one for data knows no administrators, one for administration
/// nobody else.
class ListenerRoles final : public server::RoleMapper {
public:
    /// `roles` must outlive it.
    explicit ListenerRoles(const server::RoleMapper& roles) : roles_{roles} {}

    [[nodiscard]] server::UserRights roles_of(const server::RoleQuestion& question) const override
    {
        return roles_.roles_of(question);
    }
    [[nodiscard]] server::UserRights limited(const server::RoleQuestion& question,
                                             server::UserRights rights) const override;

private:
    const server::RoleMapper& roles_;
};

} // namespace busbar::product

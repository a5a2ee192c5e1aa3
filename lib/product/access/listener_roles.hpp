#pragma once

#include <busbar/server/access_control.hpp>

namespace busbar::product {

/// Limits the roles that another mapper gives to the use of the listener that the client connected
/// to (ListenerUse): one for data admits no administrators, one for administration admits only
/// these.
class ListenerRoles final : public server::RoleMapper {
public:
    /// `roles` must outlive this object.
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

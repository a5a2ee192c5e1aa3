#pragma once

#include <cstdint>

#include <busbar/model/address_space.hpp>
#include <busbar/server/access_control.hpp>

namespace busbar::server::detail {

/// What one user may do with nodes.
struct UserRights {
    const UserIdentity& user;
    /// May be null.
    const AccessControl* control{nullptr};

    /// False for a node that the user must not know of.
    [[nodiscard]] bool may_see(const NodeId& node) const
    {
        return control == nullptr || control->may_browse(user, node);
    }
    /// Whether the user may call a Method that is executable. One that is not the server's own may
    /// change as much as a Write does.
    [[nodiscard]] bool may_call(const NodeId& method, bool is_servers_own) const
    {
        constexpr auto current_write = static_cast<std::uint8_t>(AccessLevelType::CurrentWrite);
        return (is_servers_own || (user.access_level_mask & current_write) != 0) &&
               (control == nullptr || control->may_call(user, method));
    }
    // Of the NodeManagement services.

    [[nodiscard]] bool may_add_node(const NodeId& parent) const
    {
        return is_allowed(&AccessControl::may_add_node, parent);
    }
    [[nodiscard]] bool may_delete_node(const NodeId& node) const
    {
        return is_allowed(&AccessControl::may_delete_node, node);
    }
    [[nodiscard]] bool may_add_reference(const NodeId& node) const
    {
        return is_allowed(&AccessControl::may_add_reference, node);
    }
    [[nodiscard]] bool may_remove_reference(const NodeId& node) const
    {
        return is_allowed(&AccessControl::may_remove_reference, node);
    }
    /// The UserAccessLevel of a Variable (Part 3, 5.6.2).
    [[nodiscard]] std::uint8_t access_level(const NodeId& node,
                                            const model::VariableAttributes& variable) const
    {
        unsigned level = variable.access_level;
        level &= variable.user_access_level;
        level &= user.access_level_mask;
        if (control != nullptr) {
            level &= control->user_access_level(user, node, variable.access_level);
        }
        return static_cast<std::uint8_t>(level);
    }

private:
    using Question = bool (AccessControl::*)(const UserIdentity&, const NodeId&) const;

    [[nodiscard]] bool is_allowed(Question question, const NodeId& node) const
    {
        return control == nullptr ? is_configure_admin(user) : (control->*question)(user, node);
    }
};

[[nodiscard]] constexpr bool has_access(std::uint8_t level, AccessLevelType bit)
{
    return (level & static_cast<std::uint8_t>(bit)) != 0;
}

/// What a NodeId that leads nowhere answers: a null one cannot be one of a node.
[[nodiscard]] inline StatusCode why_not_found(const NodeId& id)
{
    return id.is_null() ? status::Bad_NodeIdInvalid : status::Bad_NodeIdUnknown;
}

} // namespace busbar::server::detail

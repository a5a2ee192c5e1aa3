#include "listener_roles.hpp"

#include <utility>

#include "product/configuration/config.hpp"

namespace busbar::product {

namespace {

/// Tells whether a role administers the server (Part 3, 4.9.2).
bool is_administrative(const std::string& role)
{
    return role == "SecurityAdmin" || role == "ConfigureAdmin";
}

} // namespace

server::UserRights ListenerRoles::limited(const server::RoleQuestion& question,
                                          server::UserRights rights) const
{
    rights = roles_.limited(question, std::move(rights));
    switch (static_cast<ListenerUse>(question.listener)) {
    case ListenerUse::DataAndAdministration:
        break;
    case ListenerUse::Data:
        std::erase_if(rights.roles, is_administrative);
        break;
    case ListenerUse::Administration:
        std::erase_if(rights.roles,
                      [](const std::string& role) { return !is_administrative(role); });
        if (rights.roles.empty()) {
            rights.access_level_mask = 0;
        }
        break;
    }
    return rights;
}

} // namespace busbar::product

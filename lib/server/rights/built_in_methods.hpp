#pragma once

#include <busbar/core/node_id.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::server::detail {

/// True for ChangePassword of UserManagement, which any user with a password may call (Part 18,
/// 5.2.8).
[[nodiscard]] inline bool is_change_password(const NodeId& method)
{
    return method.is(id::UserManagement_ChangePassword);
}

/// True for a Method whose InputArguments contain a password or a private key, of an Object or of
/// its type: they are never reported.
[[nodiscard]] inline bool has_secret_inputs(const NodeId& method)
{
    constexpr std::uint32_t all[] = {id::UserManagement_AddUser,
                                     id::UserManagementType_AddUser,
                                     id::UserManagement_ModifyUser,
                                     id::UserManagementType_ModifyUser,
                                     id::UserManagement_ChangePassword,
                                     id::UserManagementType_ChangePassword,
                                     id::ServerConfiguration_UpdateCertificate,
                                     id::ServerConfigurationType_UpdateCertificate};
    for (const std::uint32_t each : all) {
        if (method.is(each)) {
            return true;
        }
    }
    return false;
}

/// True for a Method of the Server object that the server carries out itself (Part 5, 9.1 and 9.2).
[[nodiscard]] inline bool is_built_in_method(const NodeId& method)
{
    return method.is(id::Server_GetMonitoredItems) || method.is(id::Server_ResendData);
}

} // namespace busbar::server::detail

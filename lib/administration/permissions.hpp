#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <busbar/model/address_space.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/data_types.hpp>

namespace busbar::administration::detail {

/// Combines two sets of permissions (Part 3, 8.55).
[[nodiscard]] constexpr PermissionType together(PermissionType a, PermissionType b)
{
    return PermissionType{static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b)};
}

[[nodiscard]] constexpr bool has(PermissionType all, PermissionType one)
{
    return together(all, one) == all;
}

inline constexpr PermissionType may_see = together(PermissionType::Browse, PermissionType::Read);
inline constexpr PermissionType may_act = together(PermissionType::Write, PermissionType::Call);

/// Tells whether one of the user's roles has the permission at the node, provided that namespace 0
/// has all roles.
[[nodiscard]] bool may(PermissionType permission, const model::AddressSpace& space,
                       model::NodeIndex node, const server::UserIdentity& user);
[[nodiscard]] inline bool may_call(const model::AddressSpace& space, model::NodeIndex method,
                                   const server::UserIdentity& user)
{
    return may(PermissionType::Call, space, method, user);
}

/// The owner of something that outlasts a Call, such as a file handle or a transaction: one user in
/// one session. The ownership ends with the session, and when the session gets another user.
struct Holder {
    Holder(NodeId of = {}, std::uint32_t number = 0, std::string key = {})
        : session{std::move(of)}, user{number}, share{std::move(key)}
    {
    }

    NodeId session;
    /// See RunningServer::user_number.
    std::uint32_t user;
    /// See RunningServer::share_key.
    std::string share;

    friend bool operator==(const Holder&, const Holder&) = default;
};

/// Returns the present user of the session.
[[nodiscard]] Holder holder_of(server::Server& server, const NodeId& session);
[[nodiscard]] inline Holder holder_of(server::Server& server, const server::MethodCall& call)
{
    return holder_of(server, call.session_id());
}
/// True while the session exists and still has the same user.
[[nodiscard]] bool is_there(server::Server& server, const Holder& holder);
/// Checks, before a late effect, whether the caller of the Method may still call it.
/// Bad_SessionClosed if the holder is gone.
[[nodiscard]] StatusCode check_still(server::Server& server, const Holder& holder,
                                     const NodeId& object, const NodeId& method);

} // namespace busbar::administration::detail

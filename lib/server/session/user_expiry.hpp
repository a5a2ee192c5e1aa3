#pragma once

#include <busbar/core/clock.hpp>
#include <busbar/core/extension_object.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/server_config.hpp>

namespace busbar::server::detail {

struct SessionNeeds;
class Session;
struct RequestMark;

/// Sets the session's user to `user` as long as the certificate or token is valid: after that it is
/// an anonymous one or, if the endpoint allows none, the session ends (Part 4, 7.40.5).
void set_user(const SessionNeeds& needs, const EndpointConfig& endpoint, Session& session,
              UserIdentity user, TimePoint now);

/// Returns the user with the roles that the server's rules give him in this session.
[[nodiscard]] UserIdentity with_roles(const SessionNeeds& needs, const Session& session,
                                      UserIdentity user);

/// Records that the session has been activated; `is_first`: for the first time. `token` has no
/// secret.
void tell_activated(const SessionNeeds& needs, const Session& session, bool is_first,
                    const RequestMark& mark, const ExtensionObject& token);

/// Removes an expired user, in time and before the session is used. The rights of the session's
/// Subscriptions are checked again.
void expire_user(const SessionNeeds& needs, Session& session, TimePoint now);

} // namespace busbar::server::detail

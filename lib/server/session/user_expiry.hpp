#pragma once

#include <busbar/core/clock.hpp>
#include <busbar/core/extension_object.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/server_config.hpp>

namespace busbar::server::detail {

struct SessionNeeds;
class Session;
struct RequestMark;

/// The session belongs to `user` from now on, as long as his certificate or token is valid: then it
/// is an anonymous one or, where the endpoint allows none, ends (Part 4, 7.40.5).
void set_user(const SessionNeeds& needs, const EndpointConfig& endpoint, Session& session,
              UserIdentity user, TimePoint now);

/// The user with the roles that the server's rules give him in this session.
[[nodiscard]] UserIdentity with_roles(const SessionNeeds& needs, const Session& session,
                                      UserIdentity user);

/// Says that the session has been activated; `is_first`: it was not before. `token` has no secret.
void tell_activated(const SessionNeeds& needs, const Session& session, bool is_first,
                    const RequestMark& mark, const ExtensionObject& token);

/// In time, and before the session is used: takes a user away whose time is over. What the
/// session's Subscriptions may see is looked at again.
void expire_user(const SessionNeeds& needs, Session& session, TimePoint now);

} // namespace busbar::server::detail

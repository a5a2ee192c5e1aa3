#pragma once

#include <string_view>

#include <busbar/core/clock.hpp>
#include <busbar/core/extension_object.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/server_config.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/session.hpp>

#include "service.hpp"
#include "session_needs.hpp"

namespace busbar::server::detail {

// Discovery service set (Part 4, 5.5).

[[nodiscard]] StatusCode find_servers(const SessionNeeds& needs, ServiceContext& context,
                                      const FindServersRequest& request,
                                      FindServersResponse& response);
[[nodiscard]] StatusCode find_servers_on_network(const SessionNeeds& needs, ServiceContext& context,
                                                 const FindServersOnNetworkRequest& request,
                                                 FindServersOnNetworkResponse& response);
[[nodiscard]] StatusCode get_endpoints(const SessionNeeds& needs, ServiceContext& context,
                                       const GetEndpointsRequest& request,
                                       GetEndpointsResponse& response);

// Session service set (Part 4, 5.7).

[[nodiscard]] StatusCode create_session(const SessionNeeds& needs, ServiceContext& context,
                                        const CreateSessionRequest& request,
                                        CreateSessionResponse& response);
/// An Operation because the answer to a failed login is delayed.
[[nodiscard]] std::unique_ptr<ServiceOperation> make_activate_session(const SessionNeeds& needs);
[[nodiscard]] StatusCode close_session(const SessionNeeds& needs, ServiceContext& context,
                                       const CloseSessionRequest& request,
                                       CloseSessionResponse& response);
[[nodiscard]] StatusCode cancel(const SessionNeeds& needs, ServiceContext& context,
                                const CancelRequest& request, CancelResponse& response);

struct SessionNeeds;

/// Returns the URL for a client that used `requested`: with that host if it is one of the server's,
/// else the default (Part 4, 5.5.4.2).
[[nodiscard]] std::string endpoint_url_for(const SessionNeeds& needs, std::string_view requested);
/// Describes every endpoint to a client that used `requested_url`.
[[nodiscard]] Array<EndpointDescription> describe_endpoints(const SessionNeeds& needs,
                                                            std::string_view requested_url);
/// Returns the certificates of the server, leaf first; null if it has none.
[[nodiscard]] ByteString server_certificates(const SessionNeeds& needs);

/// Makes room for one more session from this address; another one may end for it, which is logged.
/// False if none can. See ServerLimits::max_sessions.
[[nodiscard]] bool make_session_place(const SessionNeeds& needs, std::string_view address);

/// Returns whether the user may activate this session, over a channel from this address; another
/// one of his may end for it. See ServerLimits::max_sessions_per_user.
[[nodiscard]] bool make_share(const SessionNeeds& needs, const Session& session,
                              const UserIdentity& user, std::string_view address);

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

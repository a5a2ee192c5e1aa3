#pragma once

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

} // namespace busbar::server::detail

#pragma once

#include <busbar/types/discovery.hpp>
#include <busbar/types/session.hpp>

#include "service.hpp"

namespace busbar::server::detail {

// Discovery service set (Part 4, 5.5).

[[nodiscard]] StatusCode find_servers(ServiceContext& context, const FindServersRequest& request,
                                      FindServersResponse& response);
[[nodiscard]] StatusCode get_endpoints(ServiceContext& context, const GetEndpointsRequest& request,
                                       GetEndpointsResponse& response);

// Session service set (Part 4, 5.7).

[[nodiscard]] StatusCode create_session(ServiceContext& context,
                                        const CreateSessionRequest& request,
                                        CreateSessionResponse& response);
/// An Operation because the answer to a failed login is held back.
[[nodiscard]] std::unique_ptr<Operation> make_activate_session();
[[nodiscard]] StatusCode close_session(ServiceContext& context, const CloseSessionRequest& request,
                                       CloseSessionResponse& response);
[[nodiscard]] StatusCode cancel(ServiceContext& context, const CancelRequest& request,
                                CancelResponse& response);

} // namespace busbar::server::detail

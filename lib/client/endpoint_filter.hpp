#pragma once

#include <busbar/client/endpoint_choice.hpp>

namespace busbar::client::detail {

/// Calls choose_endpoint without a user, for channels that carry no session, if `identity` is null.
[[nodiscard]] Result<EndpointChoice> choose_endpoint(const Array<EndpointDescription>& endpoints,
                                                     const SecurityWishes& wishes,
                                                     const UserIdentity* identity,
                                                     std::string_view reached_by, LogSink& log);

} // namespace busbar::client::detail

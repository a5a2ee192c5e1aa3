#pragma once

#include <string_view>

#include <busbar/types/discovery.hpp>

namespace busbar::server::detail {

struct SessionNeeds;

/// Returns the URL for a client that used `requested`: with that host if it is one of the server's,
/// else the default (Part 4, 5.5.4.2).
[[nodiscard]] std::string endpoint_url_for(const SessionNeeds& needs, std::string_view requested);
/// Describes every endpoint to a client that used `requested_url`.
[[nodiscard]] Array<EndpointDescription> describe_endpoints(const SessionNeeds& needs,
                                                            std::string_view requested_url);
/// Returns the certificates of the server, leaf first; null if it has none.
[[nodiscard]] ByteString server_certificates(const SessionNeeds& needs);

} // namespace busbar::server::detail

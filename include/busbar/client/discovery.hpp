#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include <busbar/client/requester.hpp>
#include <busbar/core/api.hpp>
#include <busbar/types/discovery.hpp>

/// The Discovery Service Set (Part 4, 5.5), which needs no session. `url` is the one by which the
/// server is reached; the answer may depend on it.
namespace busbar::client {

/// FindServers (Part 4, 5.5.2). `server_uris` empty: all servers that it knows.
BUSBAR_API RequestId find_servers(Requester& requester, std::string_view url,
                                  Requester::Handler<std::vector<ApplicationDescription>> done,
                                  const std::vector<std::string>& server_uris = {},
                                  RequestOptions options = {});

/// GetEndpoints (Part 4, 5.5.4).
BUSBAR_API RequestId get_endpoints(Requester& requester, std::string_view url,
                                   Requester::Handler<std::vector<EndpointDescription>> done,
                                   RequestOptions options = {});

} // namespace busbar::client

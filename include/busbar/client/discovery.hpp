#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/client/requester.hpp>
#include <busbar/core/api.hpp>
#include <busbar/types/discovery.hpp>

/// The Discovery Service Set (Part 4, 5.5), which needs no session. `url` is the one by which the
/// server is reached; the answer may depend on it.
namespace busbar::client {

/// FindServers (Part 4, 5.5.2). If `server_uris` is empty, all servers that it knows.
BUSBAR_API RequestId find_servers(Requester& requester, std::string_view url,
                                  Requester::Handler<std::vector<ApplicationDescription>> done,
                                  const std::vector<std::string>& server_uris = {},
                                  RequestOptions options = {});

/// FindServersOnNetwork (Part 4, 5.5.3): the servers with all of `capabilities` that a discovery
/// server knows from the network, at most `most`, 0 for all, with records after `after`.
BUSBAR_API RequestId find_servers_on_network(Requester& requester,
                                             Requester::Handler<FindServersOnNetworkResponse> done,
                                             const std::vector<std::string>& capabilities = {},
                                             std::uint32_t after = 0, std::uint32_t most = 0,
                                             RequestOptions options = {});

/// GetEndpoints (Part 4, 5.5.4).
BUSBAR_API RequestId get_endpoints(Requester& requester, std::string_view url,
                                   Requester::Handler<std::vector<EndpointDescription>> done,
                                   RequestOptions options = {});

} // namespace busbar::client

#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/core/result.hpp>

namespace busbar::net {

/// Where "opc.tcp://host:port/path" leads.
struct Endpoint {
    std::string host;
    std::uint16_t port{4840}; // the default of Part 6, 7.2
    std::string path;
};

/// Bad_TcpEndpointUrlInvalid for any other scheme, an empty host or a port that is none. An IPv6
/// address stands in brackets.
[[nodiscard]] Result<Endpoint> parse_endpoint_url(std::string_view url);

} // namespace busbar::net

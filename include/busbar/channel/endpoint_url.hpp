#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>

namespace busbar::channel {

/// The parts of "opc.tcp://host:port/path".
struct BUSBAR_API EndpointUrl {
    /// The host without the brackets of an IPv6 address.
    std::string host;
    std::uint16_t port{4840}; // Part 6, 7.2
    /// The path with its slash; may be empty.
    std::string path;

    /// Returns Bad_TcpEndpointUrlInvalid for another scheme, an empty host, an invalid port number,
    /// and 4,096 bytes or more (Part 6, 7.1.2.3).
    [[nodiscard]] static Result<EndpointUrl> parse(std::string_view text);
    [[nodiscard]] std::string text() const;
};

/// True if both are the same host name or address; case does not matter.
[[nodiscard]] BUSBAR_API bool is_same_host(std::string_view a, std::string_view b);

} // namespace busbar::channel

#include <busbar/channel/endpoint_url.hpp>

#include <algorithm>
#include <charconv>
#include <optional>

#include "core/ascii_case.hpp"

namespace busbar::channel {

namespace {

constexpr std::string_view scheme = "opc.tcp://";
constexpr std::size_t max_length = 4'095;

/// Splits "host:port" and "[address]:port"; the port with its colon.
std::optional<std::pair<std::string_view, std::string_view>> split(std::string_view authority)
{
    if (authority.starts_with('[')) {
        const std::size_t end = authority.find(']');
        if (end == std::string_view::npos) {
            return std::nullopt;
        }
        return std::pair{authority.substr(1, end - 1), authority.substr(end + 1)};
    }
    const std::size_t end = std::min(authority.find(':'), authority.size());
    return std::pair{authority.substr(0, end), authority.substr(end)};
}

std::optional<std::uint16_t> parse_port(std::string_view text)
{
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (error != std::errc{} || end != text.data() + text.size() || port == 0) {
        return std::nullopt;
    }
    return port;
}

} // namespace

Result<EndpointUrl> EndpointUrl::parse(std::string_view text)
{
    if (text.size() > max_length || !is_same_host(text.substr(0, scheme.size()), scheme)) {
        return fail(status::Bad_TcpEndpointUrlInvalid);
    }
    text.remove_prefix(scheme.size());
    const std::size_t end = std::min(text.find('/'), text.size());
    const auto parts = split(text.substr(0, end));
    if (!parts || parts->first.empty()) {
        return fail(status::Bad_TcpEndpointUrlInvalid);
    }
    EndpointUrl url;
    url.host = parts->first;
    url.path = text.substr(end);
    if (!parts->second.empty()) {
        const auto port =
            parts->second.front() == ':' ? parse_port(parts->second.substr(1)) : std::nullopt;
        if (!port) {
            return fail(status::Bad_TcpEndpointUrlInvalid);
        }
        url.port = *port;
    }
    return url;
}

std::string EndpointUrl::text() const
{
    const bool is_v6 = host.find(':') != std::string::npos;
    return std::string{scheme} + (is_v6 ? "[" + host + "]" : host) + ":" + std::to_string(port) +
           path;
}

bool is_same_host(std::string_view a, std::string_view b)
{
    return busbar::detail::is_same_ignoring_case(a, b);
}

} // namespace busbar::channel

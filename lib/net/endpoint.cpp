#include <busbar/net/endpoint.hpp>

#include <charconv>

namespace busbar::net {

namespace {

auto invalid()
{
    return fail(status::Bad_TcpEndpointUrlInvalid);
}

bool parse_port(std::string_view text, std::uint16_t& port)
{
    const char* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, port);
    return error == std::errc{} && stopped == end && port != 0;
}

} // namespace

Result<Endpoint> parse_endpoint_url(std::string_view url)
{
    constexpr std::string_view scheme = "opc.tcp://";
    if (url.substr(0, scheme.size()) != scheme) {
        return invalid();
    }
    url.remove_prefix(scheme.size());
    const std::size_t slash = url.find('/');
    Endpoint endpoint;
    endpoint.path = slash == std::string_view::npos ? "" : std::string{url.substr(slash)};
    std::string_view authority = url.substr(0, slash);
    std::string_view rest;
    if (authority.substr(0, 1) == "[") {
        const std::size_t bracket = authority.find(']');
        if (bracket == std::string_view::npos) {
            return invalid();
        }
        endpoint.host = authority.substr(1, bracket - 1);
        rest = authority.substr(bracket + 1);
    } else {
        const std::size_t colon = authority.find(':');
        endpoint.host = authority.substr(0, colon);
        rest = colon == std::string_view::npos ? "" : authority.substr(colon);
    }
    const bool has_port = !rest.empty();
    if (endpoint.host.empty() ||
        (has_port && (rest[0] != ':' || !parse_port(rest.substr(1), endpoint.port)))) {
        return invalid();
    }
    return endpoint;
}

} // namespace busbar::net

#include "url.hpp"

#include <algorithm>

#include <busbar/channel/endpoint_url.hpp>

#include "failure.hpp"

namespace busbar::tool {

namespace {

constexpr std::string_view scheme = "opc.tcp://";
constexpr const char* advice = "write opc.tcp://host:4840, or host:4840";

bool is_digit(char character)
{
    return character >= '0' && character <= '9';
}

bool is_host(std::string_view text)
{
    const bool has_only = std::all_of(text.begin(), text.end(), [](char character) {
        return (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z') ||
               is_digit(character) || character == '-' || character == '.' || character == '_';
    });
    // "2:8" is a browse name rather than port 8 of host 2.
    return has_only && !std::all_of(text.begin(), text.end(), is_digit);
}

/// "host:4840", "host:4840/path", "[::1]:4840".
bool is_host_with_port(std::string_view text)
{
    const bool is_v6 = text.starts_with('[');
    const std::size_t colon = is_v6 ? text.find("]:") : text.find(':');
    if (colon == std::string_view::npos) {
        return false;
    }
    const std::string_view port = text.substr(colon + (is_v6 ? 2 : 1));
    const std::string_view host = text.substr(is_v6 ? 1 : 0, colon - (is_v6 ? 1 : 0));
    const bool is_address =
        is_v6 && host.find_first_not_of("0123456789abcdefABCDEF:.%") == std::string_view::npos;
    return !port.empty() && is_digit(port.front()) && (is_address || is_host(host));
}

/// Returns the part between scheme and path.
std::string_view authority_of(std::string_view url)
{
    url.remove_prefix(std::min(scheme.size(), url.size()));
    return url.substr(0, std::min(url.find('/'), url.size()));
}

std::string found_in(std::string_view url)
{
    const std::string_view authority = authority_of(url);
    const std::size_t bracket = authority.rfind(']');
    const std::size_t colon = authority.find(':', bracket == std::string_view::npos ? 0 : bracket);
    if (authority.empty() || colon == 0) {
        return "names no host";
    }
    if (colon == std::string_view::npos) {
        return "is not a URL";
    }
    return "its port is \"" + std::string{authority.substr(colon + 1)} +
           "\", expected a number from 1 to 65535";
}

} // namespace

bool is_url(std::string_view text)
{
    // A NodeId may contain the URI of a namespace; then the part before :// is not a scheme.
    const std::size_t end = text.find("://");
    const bool has_scheme = end != std::string_view::npos &&
                            text.substr(0, end).find_first_of("=;/") == std::string_view::npos;
    return has_scheme || is_host_with_port(text);
}

std::string complete_url(const std::string& text)
{
    const std::size_t end = text.find("://");
    if (end != std::string::npos && !channel::is_same_host(text.substr(0, end + 3), scheme)) {
        throw Failure{Exit::Usage, text + ": " + text.substr(0, end) + " is not supported", advice};
    }
    std::string url = end == std::string::npos ? std::string{scheme} + text : text;
    if (!channel::EndpointUrl::parse(url)) {
        throw Failure{Exit::Usage, text + ": " + found_in(url), advice};
    }
    return url;
}

std::string host_of(const std::string& url)
{
    const auto parsed = channel::EndpointUrl::parse(url);
    return parsed ? parsed->host : std::string{};
}

} // namespace busbar::tool

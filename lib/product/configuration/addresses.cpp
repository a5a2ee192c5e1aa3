#include "addresses.hpp"

#include <algorithm>
#include <memory>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <unistd.h>

#include <busbar/channel/endpoint_url.hpp>

namespace busbar::product {

namespace {

bool is_loopback(const std::string& address)
{
    return address.starts_with("127.") || address == "::1";
}

bool is_address(const std::string& host)
{
    in6_addr buffer{};
    return ::inet_pton(AF_INET, host.c_str(), &buffer) == 1 ||
           ::inet_pton(AF_INET6, host.c_str(), &buffer) == 1;
}

bool is_ip6(const std::string& address)
{
    return address.find(':') != std::string::npos;
}

/// Link-local addresses of RFC 3927, 2.1 and RFC 4291, 2.5.6.
bool is_link_local(const std::string& address)
{
    in6_addr ip6{};
    return address.starts_with("169.254.") ||
           (::inet_pton(AF_INET6, address.c_str(), &ip6) == 1 && IN6_IS_ADDR_LINKLOCAL(&ip6));
}

bool listens_to_ip4(const std::string& address)
{
    return address.empty() || address == "0.0.0.0";
}

bool listens_to_ip6(const std::string& address)
{
    return address.empty() || address == "::";
}

std::string text_of(const sockaddr& address)
{
    char text[INET6_ADDRSTRLEN] = {};
    const void* bytes = nullptr;
    if (address.sa_family == AF_INET) {
        bytes = &reinterpret_cast<const sockaddr_in&>(address).sin_addr;
    } else if (address.sa_family == AF_INET6) {
        bytes = &reinterpret_cast<const sockaddr_in6&>(address).sin6_addr;
    }
    const bool is_written =
        bytes != nullptr && ::inet_ntop(address.sa_family, bytes, text, sizeof text) != nullptr;
    return is_written ? text : "";
}

/// Selects those of `interfaces` that other machines can reach if the server listens to all of
/// them.
std::vector<std::string> reachable(const std::vector<std::string>& interfaces,
                                   const std::string& listen_address)
{
    std::vector<std::string> found;
    for (const std::string& address : interfaces) {
        const bool is_listened_to =
            is_ip6(address) ? listens_to_ip6(listen_address) : listens_to_ip4(listen_address);
        if (is_listened_to && !is_loopback(address)) {
            found.push_back(address);
        }
    }
    if (!std::all_of(found.begin(), found.end(), is_link_local)) {
        std::erase_if(found, is_link_local);
    }
    found.resize(std::min(found.size(), max_interface_addresses));
    return found;
}

void add(std::vector<std::string>& hosts, const std::string& host)
{
    const bool is_there = std::any_of(hosts.begin(), hosts.end(), [&](const std::string& known) {
        return channel::is_same_host(known, host);
    });
    if (!is_there && !host.empty()) {
        hosts.push_back(host);
    }
}

} // namespace

std::string machine_name()
{
    char text[256] = {};
    return ::gethostname(text, sizeof text - 1) == 0 && text[0] != '\0' ? text : "localhost";
}

bool is_every_address(const std::string& address)
{
    return address.empty() || address == "0.0.0.0" || address == "::";
}

std::string default_host(const ControllerConfig& config, const std::string& machine)
{
    return is_every_address(config.address) ? machine : config.address;
}

std::vector<std::string> interface_addresses()
{
    ifaddrs* first = nullptr;
    if (::getifaddrs(&first) != 0) {
        return {};
    }
    const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> list{first, ::freeifaddrs};
    std::vector<std::string> addresses;
    for (const ifaddrs* next = first; next != nullptr; next = next->ifa_next) {
        if (next->ifa_addr != nullptr && (next->ifa_flags & IFF_UP) != 0) {
            addresses.push_back(text_of(*next->ifa_addr));
        }
    }
    std::erase(addresses, "");
    return addresses;
}

std::vector<std::string> known_hosts(const ControllerConfig& config, const std::string& machine,
                                     const std::vector<std::string>& interfaces)
{
    std::vector<std::string> hosts;
    add(hosts, default_host(config, machine));
    for (const std::string& host : config.host_names) {
        add(hosts, host);
    }
    add(hosts, machine);
    for (const std::string& address : reachable(interfaces, config.address)) {
        add(hosts, address);
    }
    if (is_every_address(config.address) || is_loopback(config.address)) {
        add(hosts, "localhost");
    }
    if (listens_to_ip4(config.address) || config.address.starts_with("127.")) {
        add(hosts, "127.0.0.1");
    }
    const bool has_ip6 = std::find(interfaces.begin(), interfaces.end(), "::1") != interfaces.end();
    if (config.address == "::" || config.address == "::1" || (config.address.empty() && has_ip6)) {
        add(hosts, "::1");
    }
    return hosts;
}

std::string address_of(const std::vector<std::string>& hosts)
{
    const auto first = std::find_if(hosts.begin(), hosts.end(), [](const std::string& host) {
        return is_address(host) && !is_loopback(host);
    });
    const auto any = std::find_if(hosts.begin(), hosts.end(), is_address);
    return first != hosts.end() ? *first
           : any != hosts.end() ? *any
           : !hosts.empty()     ? hosts.front()
                                : std::string{};
}

} // namespace busbar::product

#include "addresses.hpp"

#include <algorithm>

#include <unistd.h>

#include <busbar/channel/endpoint_url.hpp>

namespace busbar::example {

namespace {

bool is_loopback(const std::string& address)
{
    return address.starts_with("127.") || address == "::1";
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

std::vector<std::string> known_hosts(const ControllerConfig& config, const std::string& machine)
{
    std::vector<std::string> hosts;
    add(hosts, default_host(config, machine));
    for (const std::string& host : config.host_names) {
        add(hosts, host);
    }
    add(hosts, machine);
    if (is_every_address(config.address) || is_loopback(config.address)) {
        add(hosts, "localhost");
        add(hosts, config.address == "::1" ? "::1" : "127.0.0.1");
    }
    return hosts;
}

} // namespace busbar::example

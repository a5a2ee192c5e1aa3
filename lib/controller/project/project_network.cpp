#include <algorithm>
#include <charconv>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/text.hpp>
#include <busbar/server/password_rules.hpp>

#include "project_rules.hpp"

namespace busbar::controller {

namespace detail {

namespace {

constexpr std::string_view digits_and_letters = server::letters_and_digits;
constexpr std::size_t max_host_name = 253; // RFC 1035

std::string listener_place(std::size_t index, std::string_view name)
{
    return "[listener " + std::to_string(index + 1) + "] " + std::string{name};
}

/// True for ones followed by zeros.
bool is_mask(std::uint32_t mask)
{
    return mask != 0 && (~mask & (~mask + 1)) == 0;
}

ValueProblem check_listener(const ProjectListener& listener, std::size_t index, bool is_alone)
{
    const auto address = ipv4_of(listener.address);
    if (listener.address.empty() ? !is_alone : !address) {
        return wrong_value(listener_place(index, "address"), listener.address,
                           is_alone ? "an IPv4 address" : "an IPv4 address of its own");
    }
    const auto mask = ipv4_of(listener.mask);
    if (!mask || !is_mask(*mask)) {
        return wrong_value(listener_place(index, "mask"), listener.mask,
                           "a subnet mask like 255.255.255.0");
    }
    if (listener.port == 0 || listener.port > 65'535) {
        return wrong_value(listener_place(index, "port"), std::to_string(listener.port),
                           "1 to 65535");
    }
    return std::nullopt;
}

/// True if one network includes the other: it would be undefined by which listener an answer leaves
/// (SH-082679, 9.8, note 1).
bool is_one_network(const ProjectListener& a, const ProjectListener& b)
{
    const std::uint32_t mask = *ipv4_of(a.mask) & *ipv4_of(b.mask);
    return (*ipv4_of(a.address) & mask) == (*ipv4_of(b.address) & mask);
}

bool is_in_network(std::uint32_t address, const ProjectListener& listener)
{
    const auto own = ipv4_of(listener.address);
    const std::uint32_t mask = *ipv4_of(listener.mask);
    return !own || (*own & mask) == (address & mask);
}

ValueProblem check_gateway(const ProjectNetwork& network)
{
    const auto gateway = ipv4_of(network.gateway);
    const bool is_reached =
        gateway && std::any_of(network.listeners.begin(), network.listeners.end(),
                               [&](const auto& each) { return is_in_network(*gateway, each); });
    return network.gateway.empty() || is_reached
               ? ValueProblem{}
               : wrong_value("[network] gateway", network.gateway,
                             "an IPv4 address in the network of a listener");
}

ValueProblem check_host_name(const std::string& name, bool has_preset)
{
    const bool is_host =
        name.size() <= max_host_name &&
        name.find_first_not_of(std::string{digits_and_letters} + "-._") == std::string::npos;
    if (!is_host) {
        return wrong_value("[network] host_name", name,
                           "a host name: letters, digits, \"-\", \".\" and \"_\"");
    }
    return check_characters("[network] host_name", name,
                            has_preset ? Characters::UpperWord : Characters::Any);
}

} // namespace

std::optional<std::uint32_t> ipv4_of(std::string_view text)
{
    std::uint32_t address = 0;
    for (int part = 0; part < 4; ++part) {
        std::uint32_t number = 0;
        const char* const end = text.data() + text.size();
        const auto read = std::from_chars(text.data(), end, number);
        const auto length = static_cast<std::size_t>(read.ptr - text.data());
        // Refuse leading zeros, which some programs take for octal.
        if (read.ec != std::errc{} || number > 255 || (length > 1 && text.front() == '0')) {
            return std::nullopt;
        }
        address = address << 8U | number;
        text.remove_prefix(length);
        if (part < 3 && !text.starts_with('.')) {
            return std::nullopt;
        }
        text.remove_prefix(part < 3 ? 1 : 0);
    }
    return text.empty() ? std::optional{address} : std::nullopt;
}

ValueProblem check_network(const Project& project, bool has_preset)
{
    const auto& listeners = project.network.listeners;
    for (std::size_t i = 0; i < listeners.size(); ++i) {
        if (auto wrong = check_listener(listeners[i], i, listeners.size() == 1)) {
            return wrong;
        }
        for (std::size_t other = 0; other < i; ++other) {
            if (is_one_network(listeners[other], listeners[i])) {
                return wrong_value(listener_place(i, "address"), listeners[i].address,
                                   "another network than that of listener " +
                                       std::to_string(other + 1));
            }
        }
    }
    const bool has_data = std::any_of(listeners.begin(), listeners.end(), [](const auto& each) {
        return each.use != ListenerUse::Administration;
    });
    if (!has_data) {
        return wrong_value("[listener]", "none for data", "at least one");
    }
    if (auto wrong = check_gateway(project.network)) {
        return wrong;
    }
    return check_host_name(project.network.host_name, has_preset);
}

} // namespace detail

std::vector<std::string> endpoint_urls(const ProjectNetwork& network)
{
    std::vector<std::string> urls;
    for (const ProjectListener& listener : network.listeners) {
        if (listener.use == ListenerUse::Administration) {
            continue;
        }
        const auto port = static_cast<std::uint16_t>(listener.port);
        for (const std::string& host : {listener.address, network.host_name}) {
            if (!host.empty()) {
                urls.push_back(channel::EndpointUrl{host, port, {}}.text());
            }
        }
    }
    return urls;
}

} // namespace busbar::controller

#include "listening.hpp"

#include <memory>
#include <string>

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

namespace busbar::product {

std::vector<FurtherListener> listeners_of(const ControllerConfig& config)
{
    std::vector<FurtherListener> all = config.further_listeners;
    all.insert(all.begin(), {config.address, config.port, config.use});
    return all;
}

void set_listeners(ControllerConfig& config, std::span<const FurtherListener> listeners)
{
    config.address = listeners.front().address;
    config.port = listeners.front().port;
    config.use = listeners.front().use;
    config.further_listeners.assign(listeners.begin() + 1, listeners.end());
}

bool can_listen(const FurtherListener& listener)
{
    addrinfo hints{};
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_PASSIVE | AI_NUMERICHOST | AI_NUMERICSERV;
    addrinfo* found = nullptr;
    const char* const address = listener.address.empty() ? nullptr : listener.address.c_str();
    if (::getaddrinfo(address, std::to_string(listener.port).c_str(), &hints, &found) != 0) {
        return false;
    }
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> all{found, &::freeaddrinfo};
    for (const addrinfo* each = found; each != nullptr; each = each->ai_next) {
        const int socket = ::socket(each->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
        if (socket < 0) {
            continue; // the machine has no such addresses
        }
        const int yes = 1;
        ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        if (each->ai_family == AF_INET6) {
            ::setsockopt(socket, IPPROTO_IPV6, IPV6_V6ONLY, &yes, sizeof yes);
        }
        const bool is_free = ::bind(socket, each->ai_addr, each->ai_addrlen) == 0;
        ::close(socket);
        if (!is_free) {
            return false;
        }
    }
    return true;
}

} // namespace busbar::product

#include "listening.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

namespace busbar::product {

namespace {

Unexpected<Problem> cannot_listen(const FurtherListener& listener)
{
    const std::string at = listener.address.empty() ? "" : " of " + listener.address;
    return misconfigured("server.port", "cannot listen on " + std::to_string(listener.port) + at);
}

} // namespace

std::vector<FurtherListener> listeners_of(const ControllerConfig& config)
{
    std::vector<FurtherListener> all = config.further_listeners;
    all.insert(all.begin(), {config.address, config.port, config.use});
    return all;
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

Configured<void> Listening::begin()
{
    return open(told_).transform([this](std::uint16_t port) { now_.port = port; });
}

Configured<void> Listening::listen()
{
    is_reserving_ = false;
    // Any of the ports may be the one that fails.
    return loop_->listen_on_reserved()
               ? Configured<void>{}
               : misconfigured("server.port", "cannot listen, as the log says");
}

Configured<void> Listening::begin_elsewhere(Listeners last)
{
    now_.elsewhere = std::move(last);
    auto opened = now_.elsewhere.empty() ? Unexpected{Problem{}} : open(now_.elsewhere);
    now_.is_halted = !opened;
    if (now_.is_halted) {
        now_.elsewhere = {{"127.0.0.1", 0, ListenerUse::Administration}};
        opened = open(now_.elsewhere);
    }
    return opened.transform([this](std::uint16_t port) {
        now_.port = port;
        now_.elsewhere.front().port = port;
    });
}

void Listening::set_in(ControllerConfig& config) const
{
    if (is_elsewhere()) {
        const Listeners& listeners = now_.elsewhere;
        config.address = listeners.front().address;
        config.port = listeners.front().port;
        config.use = listeners.front().use;
        config.further_listeners.assign(listeners.begin() + 1, listeners.end());
    }
}

Configured<void> Listening::check(const Listeners& next) const
{
    if (next == told_) {
        return {};
    }
    for (const FurtherListener& each : next) {
        const auto is_open = [&](const FurtherListener& one) { return one.port == each.port; };
        FurtherListener tried = each;
        if (each.port == now_.port || std::ranges::any_of(told_, is_open)) {
            tried.port = 0;
        }
        if (!can_listen(tried)) {
            return cannot_listen(each);
        }
    }
    return {};
}

/// Tells whether these can be opened; closing a port closes it at all its addresses.
bool Listening::can_go_to(const Listeners& next) const
{
    return next.size() == 1 && told_.size() == 1 && next.front().port != now_.port;
}

Configured<void> Listening::go_to(Listeners next)
{
    return open(next).transform([&](std::uint16_t port) {
        left_ = Left{std::exchange(told_, std::move(next)),
                     std::exchange(now_, Place{.port = port}), false};
    });
}

bool Listening::can_go_as_told() const
{
    return is_elsewhere() && std::ranges::all_of(told_, can_listen);
}

Configured<void> Listening::go_as_told()
{
    close(now_.elsewhere);
    left_ = Left{told_, std::exchange(now_, Place{}), true};
    auto opened = open(told_);
    if (!opened) {
        go_back();
        return Unexpected{std::move(opened).error()};
    }
    now_.port = *opened;
    return {};
}

void Listening::stay()
{
    if (!left_->is_closed) {
        const Listeners& open =
            left_->place.elsewhere.empty() ? left_->told : left_->place.elsewhere;
        std::ranges::for_each(open, [this](const FurtherListener& each) {
            // Told to be any, the first one has another.
            const std::uint16_t port = each.port != 0 ? each.port : left_->place.port;
            if (port != now_.port) {
                loop_->stop_listening(port);
            }
        });
    }
    left_.reset();
}

void Listening::go_back()
{
    loop_->stop_listening(now_.port);
    if (left_->is_closed) {
        close(told_);
        static_cast<void>(open(left_->place.elsewhere)); // the loop logs what fails
    }
    told_ = std::move(left_->told);
    now_ = std::move(left_->place);
    left_.reset();
}

Configured<std::uint16_t> Listening::open(std::span<const FurtherListener> listeners)
{
    std::vector<std::uint16_t> ports;
    for (const FurtherListener& each : listeners) {
        const auto number = static_cast<std::uint32_t>(each.use);
        const auto port = is_reserving_ ? loop_->reserve(each.address, each.port, number)
                                        : loop_->listen(each.address, each.port, number);
        if (!port) {
            std::ranges::for_each(ports, [this](auto open) { loop_->stop_listening(open); });
            return cannot_listen(each);
        }
        ports.push_back(*port);
    }
    return ports.front();
}

void Listening::close(std::span<const FurtherListener> listeners)
{
    std::ranges::for_each(listeners,
                          [this](const auto& each) { loop_->stop_listening(each.port); });
}

} // namespace busbar::product

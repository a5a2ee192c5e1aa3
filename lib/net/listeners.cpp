#include "listeners.hpp"

#include <utility>

namespace busbar::net::detail {

Result<std::uint16_t> Listeners::reserve(std::string_view address, std::uint16_t port,
                                         std::uint32_t number)
{
    const auto listener = std::make_shared<Listener>(executor_, *log_);
    const auto bound = listener->reserve(address, port);
    if (bound) {
        ports_.push_back({*bound, number, listener});
    }
    return bound;
}

Result<std::uint16_t> Listeners::add(std::string_view address, std::uint16_t port,
                                     std::uint32_t number)
{
    const auto bound = reserve(address, port, number);
    if (!bound) {
        return bound;
    }
    if (const auto listens = ports_.back().listener->listen(); !listens) {
        ports_.pop_back();
        return fail(listens.error());
    }
    if (handler_) {
        start(ports_.back());
    }
    return bound;
}

Result<void> Listeners::listen()
{
    for (const Port& port : ports_) {
        if (const auto listens = port.listener->listen(); !listens) {
            return listens;
        }
    }
    return {};
}

void Listeners::start(Handler handler)
{
    handler_ = std::move(handler);
    for (const Port& port : ports_) {
        start(port);
    }
}

void Listeners::start(const Port& port) const
{
    port.listener->start([handler = handler_, number = port.listener_number](
                             asio::ip::tcp::socket socket) { handler(std::move(socket), number); });
}

void Listeners::remove(std::uint16_t number)
{
    std::erase_if(ports_, [number](const Port& port) {
        if (port.number == number) {
            port.listener->close();
        }
        return port.number == number;
    });
}

void Listeners::close()
{
    handler_ = nullptr;
    for (const Port& port : ports_) {
        port.listener->close();
    }
}

void Listeners::resume()
{
    for (const Port& port : ports_) {
        port.listener->resume();
    }
}

} // namespace busbar::net::detail

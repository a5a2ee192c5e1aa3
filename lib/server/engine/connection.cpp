#include <busbar/server/connection.hpp>

#include "peer_link.hpp"

namespace busbar::server {

Connection::Connection(std::unique_ptr<detail::PeerLink> link) : link_{std::move(link)} {}
Connection::Connection(Connection&&) noexcept = default;
Connection& Connection::operator=(Connection&&) noexcept = default;
Connection::~Connection() = default;

std::uint64_t Connection::id() const
{
    return link_->id();
}

Result<void> Connection::reverse_hello(std::string_view endpoint_url)
{
    return link_->reverse_hello(endpoint_url);
}

void Connection::came_by(std::uint32_t listener)
{
    link_->came_by(listener);
}

Result<void> Connection::feed(std::span<const std::byte> in, TimePoint now)
{
    return link_->feed(in, now);
}

bool Connection::has_enough() const
{
    return link_->has_enough();
}

std::optional<ConnectionEvent> Connection::next_event()
{
    return link_->next_event();
}

std::span<const std::byte> Connection::output() const
{
    return link_->output();
}

void Connection::consume(std::size_t size)
{
    link_->consume(size);
}

TimePoint Connection::next_deadline() const
{
    return link_->next_deadline();
}

void Connection::handle_deadline(TimePoint now)
{
    link_->handle_deadline(now);
}

bool Connection::is_closed() const
{
    return link_->is_closed();
}

} // namespace busbar::server

#include <algorithm>
#include <string>
#include <unordered_map>

#include "server/users/login_guard.hpp"
#include "server_impl.hpp"

// Decides which connection is closed to make room for another one (Part 4, 5.6.2.1).

namespace busbar::server {

namespace {

using detail::PeerLink;

bool may_go(const PeerLink& link)
{
    return !link.is_closed() && !link.has_activated_session();
}

std::size_t count_from(const std::vector<PeerLink*>& links, std::string_view address, bool is_open)
{
    return static_cast<std::size_t>(
        std::count_if(links.begin(), links.end(), [&](const PeerLink* link) {
            return link->address() == address && !(is_open && link->is_closed());
        }));
}

/// Returns null if all have sessions. `links` has the oldest first.
PeerLink* find_oldest_from(const std::vector<PeerLink*>& links, std::string_view address)
{
    const auto found = std::find_if(links.begin(), links.end(), [&](const PeerLink* link) {
        return link->address() == address && may_go(*link);
    });
    return found == links.end() ? nullptr : *found;
}

/// Returns the oldest without a session, of the network that has most of these.
PeerLink* find_oldest_of_greediest(const std::vector<PeerLink*>& links)
{
    std::unordered_map<std::string, std::size_t> networks;
    std::size_t most = 0;
    for (const PeerLink* link : links) {
        if (may_go(*link)) {
            most = std::max(most, ++networks[detail::network_of(link->address())]);
        }
    }
    const auto found = std::find_if(links.begin(), links.end(), [&](const PeerLink* link) {
        return may_go(*link) && networks[detail::network_of(link->address())] == most;
    });
    return found == links.end() ? nullptr : *found;
}

Refusal displaced(std::string_view taker, std::string_view limit)
{
    return {status::Bad_TcpServerTooBusy, "activity",
            "a connection from " + printable(taker) +
                " takes the place of this one, the oldest without an activated session; the limit "
                "is " +
                std::string{limit},
            "Part 4, 5.6.2.1", "Raise " + std::string{limit} + " if all of them are needed"};
}

} // namespace

std::string Server::Impl::find_obstacle(std::string_view peer_address)
{
    if (is_shutting_down()) {
        return "the server is stopping";
    }
    const std::string address = printable(peer_address);
    const std::size_t most = limits().max_connections_per_address;
    if (const std::size_t open = count_from(links, address, true); open >= most) {
        PeerLink* const oldest = find_oldest_from(links, address);
        if (oldest == nullptr) {
            return std::to_string(open) +
                   " connections from this address, all with sessions, the limit "
                   "max_connections_per_address";
        }
        oldest->close(displaced(address, "max_connections_per_address"));
        sweep();
    }
    // Closed connections that still send take memory, too.
    if (const std::size_t all = count_from(links, address, false); all >= 2 * most) {
        return std::to_string(all) + " connections from this address with those that are closed "
                                     "and still send, twice the limit max_connections_per_address";
    }
    if (!make_place(address)) {
        return std::to_string(links.size()) +
               " connections, all with sessions, the limit max_connections";
    }
    return {};
}

bool Server::Impl::make_place(std::string_view peer_address)
{
    const auto open = static_cast<std::size_t>(std::count_if(
        links.begin(), links.end(), [](const PeerLink* link) { return !link->is_closed(); }));
    if (open >= limits().max_connections) {
        PeerLink* const oldest = find_oldest_of_greediest(links);
        if (oldest == nullptr) {
            return false;
        }
        oldest->close(displaced(peer_address, "max_connections"));
        sweep();
    }
    return links.size() < 2 * limits().max_connections;
}

} // namespace busbar::server

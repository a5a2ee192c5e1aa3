#include <algorithm>
#include <map>
#include <string>

#include "core.hpp"
#include "peer_link.hpp"
#include "server/users/login_guard.hpp"

// Decides which unfinished message is given up when all of them together take too much, so that no
// small request is refused for the memory of others.

namespace busbar::server::detail {

namespace {

struct Holder {
    PeerLink* link{nullptr};
    /// Sum of all connections from its network.
    std::size_t together{0};
};

/// Returns the oldest connection of the network with most.
Holder find_greediest(const std::vector<PeerLink*>& links)
{
    std::map<std::string, std::size_t> networks;
    for (const PeerLink* link : links) {
        if (const std::size_t size = link->channel().unfinished_size(); size != 0) {
            networks[network_of(link->address())] += size;
        }
    }
    Holder most;
    for (PeerLink* link : links) {
        const std::size_t size = link->channel().unfinished_size();
        if (size == 0) {
            continue;
        }
        const std::size_t together = networks[network_of(link->address())];
        if (most.link == nullptr || together > most.together ||
            (together == most.together && size > most.link->channel().unfinished_size())) {
            most = {link, together};
        }
    }
    return most;
}

} // namespace

void Core::relieve_assembly(std::string_view taker)
{
    const std::size_t kept =
        std::min<std::size_t>(limits().transport.max_message_size, limits().max_assembly / 4);
    while (assembly.left() < kept) {
        const Holder found = find_greediest(links);
        if (found.link == nullptr) {
            return;
        }
        found.link->close(
            {status::Bad_TcpNotEnoughResources, "place for unfinished messages",
             "this connection holds " + std::to_string(found.link->channel().unfinished_size()) +
                 " bytes and its network " + std::to_string(found.together) +
                 ", more than any other, when " + std::string{taker} + " needs some of the " +
                 std::to_string(limits().max_assembly) + " of all",
             "Part 6, 7.1.2.5",
             "Let the client send smaller requests, or raise the limit "
             "max_assembly"});
    }
}

} // namespace busbar::server::detail

#include "replay.hpp"

#include <array>
#include <span>

#include <busbar/channel/endpoint_url.hpp>

#include "socket.hpp"

namespace busbar::bench {

namespace {

std::vector<std::byte> taken(channel::ClientChannel& client)
{
    const auto out = client.output();
    std::vector<std::byte> bytes{out.begin(), out.end()};
    client.consume(bytes.size());
    return bytes;
}

/// Whether the server did the work.
bool replay_once(const Overheard& overheard, const std::string& own_address,
                 const ::addrinfo& address)
{
    std::array<std::byte, 4'096> room;
    const Socket socket{address.ai_family};
    return socket.connect(own_address, address) && socket.send(overheard.hello) &&
           socket.answer(room) == 'A' && socket.send(overheard.open) && socket.answer(room) == 'O';
}

} // namespace

Result<Overheard> overhear(Load& load, const std::string& url)
{
    const auto endpoint = channel::EndpointUrl::parse(url);
    if (!endpoint) {
        return fail(status::Bad_TcpEndpointUrlInvalid);
    }
    Overheard overheard{endpoint->host, std::to_string(endpoint->port), {}, {}};
    const Peer peer{overheard.host, overheard.port};
    auto client = load.make_channel();
    overheard.hello = taken(client);
    std::array<std::byte, 4'096> room;
    if (peer.address() == nullptr) {
        return fail(status::Bad_CommunicationError);
    }
    const Socket socket{peer.address()->ai_family};
    if (!socket.connect({}, *peer.address()) || !socket.send(overheard.hello)) {
        return fail(status::Bad_CommunicationError);
    }
    const std::size_t size = socket.receive(room);
    if (!client.feed(std::span{room}.first(size), clock_now())) {
        return fail(status::Bad_CommunicationError);
    }
    while (client.next_event()) {
    }
    overheard.open = taken(client);
    if (overheard.open.empty()) {
        return fail(status::Bad_CommunicationError);
    }
    return overheard;
}

void replay(const Overheard& overheard, const std::string& own_address, Tally& tally)
{
    const Peer peer{overheard.host, overheard.port};
    while (!tally.is_over && peer.address() != nullptr) {
        const bool is_answered = replay_once(overheard, own_address, *peer.address());
        ++(is_answered ? tally.answered : tally.refused);
    }
}

} // namespace busbar::bench

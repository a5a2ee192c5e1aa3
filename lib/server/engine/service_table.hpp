#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <busbar/core/node_id.hpp>
#include <busbar/types/common.hpp>

#include "server/session/service.hpp"

namespace busbar::server::detail {

struct Core;
class PeerLink;

/// A request on its way to its service.
struct Incoming {
    std::vector<std::byte> message;
    RequestHeader header;
    Reply reply;
    /// The offset of the parameters in the message, after the header.
    std::size_t offset;
    PeerLink& link;
};

/// A service's requirements on the session that the request names.
enum class Need : std::uint8_t {
    Nothing,   // the token is ignored
    Known,     // a session; the service itself checks the rest
    Activated, // an activated session of this channel
};

/// The worst state of the server in which a service works (Part 5, 12.6).
enum class Lasts : std::uint8_t {
    WhileRunning, // and while it is suspended, in which case its sources are suspended too
    WhenFailed,   // for clients that look for the cause and request another state
    InCountdown,  // while it shuts down too, as long as that can be cancelled
    ToTheEnd,     // while it shuts down too
};

struct Service {
    std::uint32_t encoding_id;
    Need need;
    Lasts lasts;
    /// If null, the service is known, but not supported.
    void (*run)(Core& core, ServiceContext& context, Incoming& incoming);
};

/// The services of one server by the encoding ids of their requests. Knows every request of Part 4
/// and carries out those that were added.
class ServiceTable {
public:
    ServiceTable();

    /// Adds services, also for requests that are not in Part 4.
    void add(std::span<const Service> services);
    /// Returns null for a request that is neither in Part 4 nor added.
    [[nodiscard]] const Service* find(const NodeId& encoding_id) const;

private:
    /// At least one for each request of Part 4, in the order of their ids.
    std::vector<Service> services_;
};

/// True for the encoding id of a response of Part 4, which a server never gets.
[[nodiscard]] bool is_response(const NodeId& encoding_id);

} // namespace busbar::server::detail

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
    /// Where the parameters begin in the message, behind the header.
    std::size_t offset;
    PeerLink& link;
};

/// What a service needs of the session that the request names.
enum class Need : std::uint8_t {
    Nothing,   // the token is not looked at
    Known,     // a session; the service itself checks the rest
    Activated, // an activated session of this channel
};

/// The worst state of the server that a service works in (Part 5, 12.6).
enum class Lasts : std::uint8_t {
    WhileRunning, // and while it is suspended: its sources are
    WhenFailed,   // for whoever looks what is wrong and asks for another state
    InCountdown,  // while it shuts down too, as long as that can be taken back
    ToTheEnd,     // while it shuts down too
};

struct Service {
    std::uint32_t encoding_id;
    Need need;
    Lasts lasts;
    /// Null: known, but not supported.
    void (*run)(Core& core, ServiceContext& context, Incoming& incoming);
};

/// The services of one server by the encoding ids of their requests. Knows every request of Part 4
/// and carries out what was added.
class ServiceTable {
public:
    ServiceTable();

    /// Also those of requests that are not of Part 4.
    void add(std::span<const Service> services);
    /// Null for what is no request of Part 4 and was not added.
    [[nodiscard]] const Service* find(const NodeId& encoding_id) const;

private:
    /// At least one for each request of Part 4, in the order of their ids.
    std::vector<Service> services_;
};

/// The encoding id of a response of Part 4, which no server gets.
[[nodiscard]] bool is_response(const NodeId& encoding_id);

} // namespace busbar::server::detail

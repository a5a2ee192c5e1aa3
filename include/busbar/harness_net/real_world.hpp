#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/harness/world.hpp>

namespace busbar::harness {

/// A world whose time passes as the clock does, so that threads, real clients and real servers can
/// take part: what runs it (run_for(), the verbs of hosts and benches) takes as long as it says,
/// and serves sockets meanwhile. Connections of real peers go through the world's network: weather,
/// faults, recorder and trace see them as all others.
///
///     RealWorld world;
///     server::ServerConfig config = open_server_config();
///     config.endpoint_url = need(world.open("127.0.0.1"));   // "opc.tcp://127.0.0.1:43215"
///     ServerHost server{world, config};
///     world.run_for(10s);                                     // for clients that connect
///
/// One thread. Its seed, unless BUSBAR_SEED sets it, is another one each time: peers refuse a nonce
/// that they have seen before. Lives longer than all that is in it, as every world.
class BUSBAR_API RealWorld final : public World {
public:
    /// The time begins now.
    RealWorld();
    ~RealWorld();

    /// Opens a listening socket at the IP address and returns its URL, with the port that the
    /// system has chosen if `port` is 0. A client that connects to it gets to what listens at this
    /// URL in the world's network at that time, or is turned away. Bad_CommunicationError, with the
    /// reason in the log.
    [[nodiscard]] Result<std::string> open(std::string_view address, std::uint16_t port = 0);
    /// From now on connections to host and port of `url` in the world go to that address on the
    /// real network. Bad_TcpEndpointUrlInvalid; Bad_InvalidState if a listener is there in the
    /// world already.
    Result<void> reach(std::string_view url);
    /// From now on connections to `from` in the world, which may be the URL of an open socket, go
    /// to the address of `to` on the real network: a proxy, whose faults and trace are the world's.
    /// Errors as for reach(), which is this with one URL.
    Result<void> forward(std::string_view from, std::string_view to);
    /// The number of connections to real peers that exist.
    [[nodiscard]] std::size_t socket_count() const;

private:
    class Sockets;

    std::unique_ptr<Sockets> sockets_;
};

} // namespace busbar::harness

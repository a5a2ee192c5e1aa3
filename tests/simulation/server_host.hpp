#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string_view>

#include <busbar/server/server.hpp>

#include "simulated_link.hpp"
#include "support/server_fixture.hpp"

namespace busbar::test {

/// Runs a server in virtual time as the network layer does in real time.
class ServerHost final : private server::Waker {
public:
    ServerHost(Scheduler& scheduler, const WallClock& clock, Chance chance,
               server::ServerConfig config);
    ~ServerHost() override;

    [[nodiscard]] server::Server& server() { return *server_; }
    /// Gives the link its other end; false if the server has no place.
    [[nodiscard]] bool accept(const std::shared_ptr<SimulatedLink>& link,
                              std::string_view peer_address);

private:
    class Peer;

    void wake() override;
    /// Looks after what the last call left behind: deadlines, and output of other connections.
    void settle();
    void forget(std::uint64_t id);

    Scheduler& scheduler_;
    Chance chance_;
    SeededRandom random_;
    LogBook log_;
    crypto::InsecureAcceptAnyCertificate validator_;
    PlainUsers users_;
    std::unique_ptr<server::Server> server_;
    std::map<std::uint64_t, std::unique_ptr<Peer>> peers_;
    Alarm deadline_;
    Alarm completions_;
};

} // namespace busbar::test

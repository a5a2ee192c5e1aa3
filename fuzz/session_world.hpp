#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "support/job_list.hpp"
#include "support/server_fixture.hpp"

/// A server with few places for sessions, and clients of which one has a secure channel, for a
/// script that opens, takes and ends sessions in any way.
namespace busbar::fuzz {

/// What a client needs to come back to a session, on whatever channel.
struct Ticket {
    NodeId token;
    ByteString server_nonce;
};

class SessionWorld {
public:
    static constexpr std::size_t client_count = 4;

    SessionWorld();
    /// All as it was at first, with clients that have no sessions.
    void begin();
    /// Ends the connections and lets the time pass; requires that nothing is left.
    void end();

    /// The first two have one address, the next another one; the last one signs its messages.
    [[nodiscard]] test::TestClient& client(std::size_t index);
    /// The connection dies; its sessions stay until they expire.
    void drop(std::size_t index) { clients_[index].reset(); }
    void advance(Duration time);
    /// Ends logins of users who may not come in any more.
    void change_access();
    /// Does the oldest job.
    void work();
    /// Requires that the limits hold, and that answers that have come late can be read.
    void check();

    [[nodiscard]] const server::ServerLimits& limits() const { return server_.config().limits; }
    /// Sessions of this input, those that have ended too, behind one that never was.
    std::vector<Ticket> tickets;
    test::PlainUsers users;
    /// For passwords, if the users say so.
    test::JobList jobs;

private:
    [[nodiscard]] static server::ServerConfig config();
    [[nodiscard]] bool is_busy() const;

    test::SeededRandom random_;
    test::FixedWallClock wall_clock_;
    NullLog log_;
    crypto::InsecureAcceptAnyCertificate validator_;
    test::SilentWaker waker_;
    TimePoint now_{};
    server::Server server_;
    std::array<std::optional<test::TestClient>, client_count> clients_;
};

} // namespace busbar::fuzz

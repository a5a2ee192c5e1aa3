#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client_port.hpp"
#include "harness_names.hpp"
#include "hostile_ends.hpp"
#include "trace.hpp"

namespace busbar::test {

/// A client that wants the server to fail the others. It attacks for some minutes, in one way, and
/// leaves without a word; after a while it is back and does it in another way.
class Attacker {
public:
    Attacker(const HostileParts& parts, std::size_t number, Chance chance);

    void start();
    /// Goes, and does not come back before start().
    void leave();

private:
    enum class Way : std::uint8_t {
        Silence,       // sockets on which nothing is said
        OpenMessages,  // messages whose last byte never comes
        Replay,        // an OpenSecureChannel request that was sent before
        Sessions,      // sessions that are never activated
        Subscriptions, // as many as there is room for, and away
        Browse,        // requests without waiting for answers
        Logins,        // wrong passwords, for the names of others
        Garbage,       // bytes of no meaning
    };
    static constexpr std::size_t ways = 8;

    void begin();
    void act();
    void open_socket(const std::vector<std::byte>& bytes);
    void open_port(HostilePort::Then then);
    void record_channel();
    void withhold();
    void flood_sessions();
    void flood_subscriptions();
    void flood_browse();
    void guess_passwords();
    [[nodiscard]] std::vector<std::byte> garbage();
    void drop_all();

    HostileParts parts_;
    std::size_t number_;
    Chance chance_;
    std::string address_;
    Way way_{Way::Silence};
    int acts_{0};
    /// Attacks up to now.
    std::size_t tried_{0};
    /// What a client over a secure channel has sent up to its OpenSecureChannel request.
    std::shared_ptr<std::vector<std::byte>> recorded_{std::make_shared<std::vector<std::byte>>()};
    std::vector<std::unique_ptr<HostileSocket>> sockets_;
    std::vector<std::unique_ptr<HostilePort>> ports_;
    Alarm act_;
};

} // namespace busbar::test

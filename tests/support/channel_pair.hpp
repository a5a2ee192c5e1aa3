#pragma once

#include <algorithm>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/channel/client_channel.hpp>
#include <busbar/channel/server_channel.hpp>
#include <busbar/types/common.hpp>

#include "support/byte_pipe.hpp"
#include "support/hand_worker.hpp"
#include "support/identity.hpp"
#include "support/seeded_random.hpp"

namespace busbar::test {

[[nodiscard]] inline channel::SecuritySetting setting(std::string_view policy,
                                                      MessageSecurityMode mode)
{
    return {crypto::find_policy_by_name(policy), mode};
}

/// Where a server does its asymmetric work.
enum class Way { InPlace, Worker };

/// A client's and a server's channel joined by memory, in virtual time.
class ChannelPair {
public:
    explicit ChannelPair(channel::SecuritySetting security = {},
                         channel::TransportLimits server_limits = {},
                         channel::TransportLimits client_limits = {}, Way way = Way::InPlace)
        : server{server_config(security, server_limits), server_environment(way), now},
          client{client_config(security, client_limits), environment(client_identity()), now}
    {
    }

    /// Lets both sides talk until nothing moves; the events of each are kept.
    void run(std::size_t piece = SIZE_MAX)
    {
        bool moved = true;
        while (moved) {
            moved = run_to_server(piece);
            moved = run_to_client(piece) || moved;
        }
    }
    void advance(Duration time)
    {
        now += time;
        wall_clock.time.ticks += time.count() / 100;
        client.handle_deadline(now);
        server.handle_deadline(now);
        run();
    }
    /// Lets one direction's bytes through; the answer stays in the other side's output.
    bool run_to_server(std::size_t piece = SIZE_MAX)
    {
        const auto poll = [this] {
            do {
                collect(server, server_events);
            } while (worker.finish(server, now));
        };
        poll();
        return carry(client, server, now, piece, poll);
    }
    bool run_to_client(std::size_t piece = SIZE_MAX)
    {
        const auto poll = [this] { collect(client, client_events); };
        poll();
        return carry(server, client, now, piece, poll);
    }
    /// The newest event of that kind, or null.
    template <typename Events>
    [[nodiscard]] static const channel::ChannelEvent* find(const Events& events,
                                                           channel::ChannelEvent::Kind kind)
    {
        const auto found = std::find_if(events.rbegin(), events.rend(),
                                        [&](const auto& e) { return e.kind == kind; });
        return found == events.rend() ? nullptr : &*found;
    }

    SeededRandom random;
    FixedWallClock wall_clock;
    LogBook log;
    crypto::InsecureAcceptAnyCertificate validator;
    HandWorker worker;
    TimePoint now{};
    std::vector<channel::ChannelEvent> server_events;
    std::vector<channel::ChannelEvent> client_events;
    channel::ServerChannel server;
    channel::ClientChannel client;

private:
    template <typename Engine>
    static void collect(Engine& engine, std::vector<channel::ChannelEvent>& events)
    {
        while (auto event = engine.next_event()) {
            events.push_back(*std::move(event));
        }
    }
    [[nodiscard]] channel::ChannelEnvironment
    environment(const channel::ApplicationIdentity& identity)
    {
        return {.random = &random,
                .wall_clock = &wall_clock,
                .log = &log,
                .validator = &validator,
                .identity = &identity};
    }
    [[nodiscard]] channel::ChannelEnvironment server_environment(Way way)
    {
        channel::ChannelEnvironment all = environment(server_identity());
        all.worker = way == Way::Worker ? &worker : nullptr;
        return all;
    }
    [[nodiscard]] static channel::ServerChannelConfig
    server_config(channel::SecuritySetting security, channel::TransportLimits limits)
    {
        channel::ServerChannelConfig config;
        config.limits = limits;
        config.allowed = {security};
        config.channel_id = 77;
        return config;
    }
    [[nodiscard]] static channel::ClientChannelConfig
    client_config(channel::SecuritySetting security, channel::TransportLimits limits)
    {
        channel::ClientChannelConfig config;
        config.limits = limits;
        config.endpoint_url = "opc.tcp://localhost:4840";
        config.security = security;
        config.server_certificate = server_identity().certificates.front();
        config.requested_lifetime = std::chrono::minutes{1};
        return config;
    }
};

} // namespace busbar::test

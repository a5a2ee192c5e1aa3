#pragma once

#include <optional>
#include <vector>

#include <busbar/client/client.hpp>

#include "crypto/status_text.hpp"
#include "support/rogue_server.hpp"

namespace busbar::test {

/// A client and a server that lies.
class RogueFixture {
public:
    explicit RogueFixture(bool is_secure = false)
        : client{config(is_secure), environment(client_identity()), now}
    {
        if (is_secure) {
            answers.security.push_back({crypto::find_policy_by_name("Basic256Sha256"),
                                        MessageSecurityMode::SignAndEncrypt});
        }
    }
    void run()
    {
        bool moved = true;
        while (moved) {
            moved = client.poll(now);
            if (server) {
                moved = carry(client, *server, now) || moved;
                moved = carry(*server, client, now) || moved;
            }
            if (const auto order = client.next_order()) {
                obey(*order);
                moved = true;
            }
        }
    }
    void advance(Duration time)
    {
        now += time;
        client.handle_deadline(now);
        run();
    }
    void cut()
    {
        server.reset();
        client.disconnected(last_order, status::Bad_ConnectionClosed, now);
        run();
    }
    void connect()
    {
        client.connect(now);
        run();
    }
    [[nodiscard]] bool is_ready() const { return client.state() == client::ClientState::Ready; }
    void read()
    {
        client.call<ReadResponse>(ReadRequest{}, [this](Result<ReadResponse> response) {
            results.push_back(response ? StatusCode{} : response.error());
        });
        run();
    }

    TimePoint now{};
    SeededRandom random;
    FixedWallClock wall_clock;
    LogBook log;
    crypto::InsecureAcceptAnyCertificate validator;
    RogueAnswers answers;
    std::optional<RogueServer> server;
    client::Client client;
    std::vector<StatusCode> results;
    int connections{0};
    /// The last connection that was dropped ended with CloseSession.
    bool was_closed{false};
    std::uint64_t last_order{0};

private:
    [[nodiscard]] static client::ClientConfig config(bool is_secure)
    {
        client::ClientConfig config;
        config.endpoint_url = "opc.tcp://localhost:4840";
        config.application_uri = "urn:busbar:test:client";
        config.security.allows_none = !is_secure;
        return config;
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
    void obey(const client::TransportOrder& order)
    {
        if (order.kind == client::TransportOrder::Kind::Drop) {
            if (server) {
                carry(client, *server, now);
                was_closed = !server->requests.empty() &&
                             server->requests.back().is(CloseSessionRequest::binary_encoding_id);
            }
            server.reset();
            client.disconnected(order.id, {}, now);
            return;
        }
        server.reset();
        ++connections;
        last_order = order.id;
        server.emplace(answers, environment(server_identity()), now);
        client.connected(order.id, now);
    }
};

} // namespace busbar::test

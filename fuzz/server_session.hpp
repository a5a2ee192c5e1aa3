#pragma once

#include <optional>
#include <span>
#include <vector>

#include <busbar/server/server.hpp>
#include <busbar/types/registry.hpp>
#include <busbar/types/session.hpp>

#include "kept_world.hpp"
#include "quick_modules.hpp"
#include "support/channel_pair.hpp"

namespace busbar::fuzz {

/// A server without security, and a client channel that speaks to it.
struct ServerSession {
    explicit ServerSession(server::UserStore* users = nullptr, bool has_node_management = false,
                           Waker* waker = nullptr)
        : server{make_server(users, has_node_management, waker)}
    {
        connect();
    }

    void connect()
    {
        connection.emplace(*server.connect("127.0.0.1", now));
        connected_at = now;
        channel::ClientChannelConfig config;
        config.endpoint_url = "opc.tcp://localhost:4840";
        client.emplace(
            config,
            channel::ChannelEnvironment{.random = &random, .wall_clock = &wall_clock, .log = &log},
            now);
        run();
    }

    server::Server make_server(server::UserStore* users, bool has_node_management, Waker* waker)
    {
        server::ServerConfig config;
        config.has_node_management = has_node_management;
        config.endpoints = {{}};
        config.endpoints[0].allows_anonymous = true;
        config.endpoints[0].allows_user_name = false;
        config.limits.events.max_raised_events = 16; // whose places are written for each server
        const server::ServerEnvironment environment{.random = &random,
                                                    .wall_clock = &wall_clock,
                                                    .log = &log,
                                                    .users = users,
                                                    .waker = waker};
        return *server::Server::create(quick_modules(), config, environment);
    }
    /// Ends the session and the connection, unless that may stay, and lets the time pass until all
    /// that they made has ended, too. False if that takes long: this is the end of the server then.
    [[nodiscard]] bool disconnect()
    {
        CloseSessionRequest close;
        close.delete_subscriptions = true;
        send(std::move(close));
        token = {};
        responses.clear();
        if (!keeps_connection || connection->is_closed() || is_busy() || now != connected_at) {
            client.reset();
            connection.reset();
        }
        for (int i = 0; i < 100 && is_busy(); ++i) { // Subscriptions count late deadlines once
            now += std::chrono::minutes{3};
            server.handle_deadline(now);
        }
        return !is_busy();
    }
    [[nodiscard]] bool is_busy() const
    {
        return server.session_count() + server.subscription_count() != 0;
    }
    void pass(Duration time)
    {
        now += time;
        server.handle_deadline(now);
        connection->handle_deadline(now);
        run();
    }
    void run()
    {
        while (test::carry(*client, *connection, now) || test::carry(*connection, *client, now)) {
            while (connection->next_event()) {
            }
            while (auto event = client->next_event()) {
                if (event->kind == channel::ChannelEvent::Kind::Message) {
                    responses.push_back(std::move(event->body));
                }
            }
        }
    }
    /// Sends a message body as it is.
    void send_body(std::span<const std::byte> body)
    {
        static_cast<void>(client->send([&](binary::Writer& writer) { writer.bytes(body); }));
        run();
    }
    template <typename Request>
    void send(Request request)
    {
        request.request_header.authentication_token = token;
        static_cast<void>(client->send([&](binary::Writer& writer) {
            encode(writer, NodeId{0, Request::binary_encoding_id});
            encode(writer, request);
        }));
        run();
    }
    /// A session whose token later requests carry.
    void log_in()
    {
        CreateSessionRequest create;
        create.client_nonce = ByteString{std::vector<std::byte>(32)};
        create.requested_session_timeout = 60'000;
        send(std::move(create));
        if (responses.empty()) {
            return;
        }
        binary::Reader reader{responses.back()};
        NodeId id;
        decode(reader, id);
        CreateSessionResponse created;
        if (id.is(CreateSessionResponse::binary_encoding_id)) {
            decode(reader, created);
            token = created.authentication_token;
            ActivateSessionRequest activate;
            AnonymousIdentityToken anonymous;
            anonymous.policy_id = created.server_endpoints[0].user_identity_tokens[0].policy_id;
            activate.user_identity_token = ExtensionObject::from(anonymous);
            send(std::move(activate));
        }
    }

    test::SeededRandom random;
    test::FixedWallClock wall_clock;
    NullLog log;
    TimePoint now{};
    server::Server server;
    /// Whether the next input may use the same connection: if nothing can be wrong with that, as
    /// its messages are made by a client, and if no time has passed.
    bool keeps_connection{false};
    TimePoint connected_at{};
    std::optional<server::Connection> connection;
    std::optional<channel::ClientChannel> client;
    NodeId token;
    std::vector<std::vector<std::byte>> responses;
};

/// One ServerSession for many inputs.
template <typename Session>
class KeptServer {
public:
    /// Returns a server with a connection, without a session. The connection is new, unless the one
    /// of the input before may be used again, see ServerSession::keeps_connection.
    [[nodiscard]] Session& begin()
    {
        session_ = &kept_.next();
        if (!session_->connection) {
            session_->connect();
        }
        return *session_;
    }
    void end()
    {
        if (!session_->disconnect()) {
            kept_.drop();
        }
    }

private:
    KeptWorld<Session> kept_;
    Session* session_{nullptr};
};

} // namespace busbar::fuzz

#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <busbar/client/client.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "crypto/status_text.hpp"
#include "server/user_fixture.hpp"

namespace busbar::test {

/// A Client and the server of a fixture, joined by memory in virtual time, with a network between
/// them that can be cut.
class ClientFixture {
public:
    explicit ClientFixture(client::ClientConfig config = named_user(),
                           server::ServerConfig server = UserFixture::all_kinds())
        : is_reverse{config.is_reverse}, server_config{server},
          site{std::make_unique<UserFixture>(std::move(server))}, client{std::move(config),
                                                                         environment(), now}
    {
        validator.used = &accept_any;
        client.on_state([this](client::ClientState state, StatusCode why) {
            states.emplace_back(state, why);
            if (also_on_state) {
                also_on_state(state);
            }
        });
    }

    [[nodiscard]] static client::ClientConfig configuration(client::UserIdentity identity)
    {
        client::ClientConfig config;
        config.endpoint_url = "opc.tcp://localhost:4840";
        config.application_uri = "urn:busbar:test:client";
        config.identity = std::move(identity);
        return config;
    }
    [[nodiscard]] static client::ClientConfig named_user()
    {
        return configuration(client::NamedUser{"operator", "operator-secret"});
    }
    [[nodiscard]] static client::UserIdentity certificate_user()
    {
        const auto& user = user_certificate();
        return client::CertificateUser{user.certificate,
                                       std::make_shared<crypto::PrivateKey>(user.key)};
    }
    /// Without security, which the server allows to anonymous users.
    [[nodiscard]] static client::ClientConfig insecure()
    {
        auto config = configuration(client::AnonymousUser{});
        config.security.allows_none = true;
        return config;
    }
    [[nodiscard]] channel::ChannelEnvironment environment()
    {
        return {.random = &random,
                .wall_clock = &wall_clock,
                .log = &log,
                .validator = &validator,
                .identity = &client_identity()};
    }

    /// Lets both sides talk until nothing moves.
    void run()
    {
        while (step()) {
        }
    }
    /// Wants a session, and lets it come.
    void connect()
    {
        client.connect(now);
        run();
    }
    [[nodiscard]] bool is_ready() const { return client.state() == client::ClientState::Ready; }

    /// Time passes; everything that is due on the way happens at its moment.
    void advance(Duration time)
    {
        const TimePoint end = now + time;
        while (true) {
            const TimePoint next = std::clamp(next_deadline(), now, end);
            pass(next - now);
            run();
            if (next == end) {
                break;
            }
        }
    }
    /// The clock jumps: nobody was awake in between.
    void jump(Duration time)
    {
        pass(time);
        run();
    }
    /// The connection breaks. What is on its way is lost; the server notices.
    void cut(StatusCode why = status::Bad_ConnectionClosed)
    {
        link.reset();
        client.disconnected(order, why, now);
        run();
    }
    /// Another server takes the place of the old one.
    void restart(server::ServerConfig config)
    {
        link.reset();
        site = std::make_unique<UserFixture>(std::move(config));
        site->wall_clock.time = wall_clock.time;
        site->now = now;
        client.disconnected(order, status::Bad_ConnectionClosed, now);
        run();
    }

    /// Reads Server_State; what became of it is in `answers`.
    client::RequestId read(client::RequestOptions options = {})
    {
        ReadRequest request;
        ReadValueId value;
        value.node_id = NodeId{0, id::Server_ServerStatus_State};
        value.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        request.nodes_to_read = {value};
        return client.call<ReadResponse>(
            std::move(request),
            [this](Result<ReadResponse> response) {
                answers.push_back(response ? response->response_header.service_result
                                           : response.error());
            },
            options);
    }

    /// The server calls, as the client waits for it to.
    void call()
    {
        accept();
        run();
    }

    const bool is_reverse;
    TimePoint now{};
    FixedWallClock wall_clock;
    SeededRandom random{7};
    LogBook log;
    crypto::InsecureAcceptAnyCertificate accept_any;
    /// Of the client; the server has its own.
    class Switch final : public crypto::CertificateValidator {
    public:
        [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                             const crypto::ValidationContext& context) override
        {
            ++asked;
            return used->validate(chain, context);
        }
        crypto::CertificateValidator* used{nullptr};
        int asked{0};
    };
    Switch validator{};
    server::ServerConfig server_config;
    std::unique_ptr<UserFixture> site;
    client::Client client;

    std::vector<std::pair<client::ClientState, StatusCode>> states;
    std::vector<StatusCode> answers;
    std::function<void(client::ClientState)> also_on_state;
    /// Every transport that was ordered, in turn.
    std::vector<std::string> urls;
    /// False: orders are left alone.
    bool is_obeying{true};
    /// False: connecting fails.
    bool is_reachable{true};
    /// The one URL that leads to the server; empty: all do.
    std::string only_way;
    /// Connections that the server refuses with an Error message, and why.
    int refusals{0};
    StatusCode refusal{status::Bad_TcpNotEnoughResources};
    /// False: the server does not end connections that the client has closed.
    bool is_closing{true};
    /// False: what either says does not arrive.
    bool is_carrying{true};
    /// Bytes to the client that arrive yet before the connection breaks.
    std::size_t bytes_left{SIZE_MAX};
    std::optional<server::Connection> link;
    std::uint64_t order{0};

private:
    [[nodiscard]] TimePoint next_deadline() const
    {
        TimePoint next = std::min(client.next_deadline(), site->server.next_deadline());
        return link ? std::min(next, link->next_deadline()) : next;
    }
    void pass(Duration time)
    {
        now += time;
        site->now = now - time;
        site->advance(time);
        wall_clock.time = site->wall_clock.time;
        if (link) {
            link->handle_deadline(now);
        }
        client.handle_deadline(now);
    }
    bool step()
    {
        bool moved = client.poll(now);
        if (link && is_carrying) {
            moved = carry(client, *link, now) || moved;
            moved = to_client() || moved;
        }
        if (link && link->is_closed() && link->output().empty() && is_closing) {
            cut_quietly();
            moved = true;
        }
        auto wanted = is_obeying ? client.next_order() : std::nullopt;
        if (wanted) {
            obey(*wanted);
        }
        return moved || wanted;
    }
    bool to_client()
    {
        auto bytes = take_output(*link);
        const bool breaks = bytes.size() > bytes_left;
        bytes.resize(std::min(bytes.size(), bytes_left));
        bytes_left = bytes_left == SIZE_MAX ? bytes_left : bytes_left - bytes.size();
        if (!bytes.empty()) {
            static_cast<void>(client.feed(bytes, now));
        }
        if (breaks) {
            client.poll(now);
            cut_quietly();
        }
        return !bytes.empty() || breaks;
    }
    /// Part 6, 7.1.2.5: a header of 8 bytes, the status, a null String.
    [[nodiscard]] static std::vector<std::byte> error_message(StatusCode why)
    {
        std::vector<std::byte> bytes;
        for (const char c : std::string_view{"ERRF"}) {
            bytes.push_back(static_cast<std::byte>(c));
        }
        for (const std::uint32_t word : {16U, why.value(), 0xFFFFFFFFU}) {
            for (int shift = 0; shift < 32; shift += 8) {
                bytes.push_back(static_cast<std::byte>(word >> shift));
            }
        }
        return bytes;
    }
    void cut_quietly()
    {
        link.reset();
        client.disconnected(order, status::Bad_ConnectionClosed, now);
    }
    void obey(const client::TransportOrder& wanted)
    {
        if (wanted.kind == client::TransportOrder::Kind::Drop) {
            if (link && is_carrying) {
                carry(client, *link, now);
            }
            if (wanted.awaits_peer && link) {
                return; // step() sees the server close
            }
            link.reset();
            client.disconnected(wanted.id, {}, now);
            return;
        }
        urls.push_back(wanted.url);
        order = wanted.id;
        if (!is_reachable || (!only_way.empty() && wanted.url != only_way)) {
            client.disconnected(order, status::Bad_CommunicationError, now);
            return;
        }
        if (!is_reverse) {
            accept();
        }
    }
    void accept()
    {
        if (refusals > 0) {
            --refusals;
            link.reset();
            client.connected(order, now);
            static_cast<void>(client.feed(error_message(refusal), now));
            client.poll(now);
            client.disconnected(order, status::Bad_ConnectionClosed, now);
            return;
        }
        link.emplace(site->server.connect("192.0.2.1", now).value());
        if (is_reverse) {
            static_cast<void>(link->reverse_hello("opc.tcp://localhost:4840"));
        }
        client.connected(order, now);
    }
};

} // namespace busbar::test

#include <cstdint>
#include <vector>

#include <busbar/server/memory_source.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/registry.hpp>
#include <busbar/types/session.hpp>

#include "fuzz_script.hpp"
#include "support/channel_pair.hpp"

using namespace busbar;

namespace {

/// A server without security with one variable, and a client channel that speaks to it.
struct Fixture {
    Fixture() : server{make_server()}, connection{*server.connect("127.0.0.1", now)}
    {
        channel::ClientChannelConfig config;
        config.endpoint_url = "opc.tcp://localhost:4840";
        client.emplace(
            config, channel::ChannelEnvironment{&random, &wall_clock, &log, nullptr, nullptr}, now);
        run();
    }

    server::Server make_server()
    {
        server::ServerConfig config;
        config.endpoints = {{}};
        config.endpoints[0].allows_anonymous = true;
        config.endpoints[0].allows_user_name = false;
        server::ServerEnvironment environment;
        environment.random = &random;
        environment.wall_clock = &wall_clock;
        environment.log = &log;
        return *server::Server::create(config, environment);
    }
    void run()
    {
        while (test::carry(*client, connection, now) || test::carry(connection, *client, now)) {
            while (connection.next_event()) {
            }
            while (auto event = client->next_event()) {
                if (event->kind == channel::Event::Kind::Message) {
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
    server::Connection connection;
    std::optional<channel::ClientChannel> client;
    NodeId token;
    std::vector<std::vector<std::byte>> responses;
};

/// Any request of namespace 0, its fields as the script decodes them, with a valid session.
void send_request(Fixture& fixture, fuzz::Script& script)
{
    const auto table = binary::namespace0_types();
    const std::size_t choice = script.byte() + std::size_t{script.byte()} * 256;
    const StructureType& type = *table[choice % table.size()];
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, type.binary_encoding_id.in(0));
    RequestHeader header;
    header.authentication_token = fixture.token;
    header.timeout_hint = script.byte();
    encode(writer, header);
    writer.bytes(script.bytes(script.byte() * std::size_t{4}));
    fixture.send_body(sink.take(writer.written()));
}

} // namespace

/// A whole server connection: raw bytes, message bodies and requests of a session, and time.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    Fixture fixture;
    if (script.byte() % 4 != 0) {
        fixture.log_in();
    }
    for (int step = 0; step < 24 && !script.is_over(); ++step) {
        switch (script.byte() % 8) {
        case 0:
            static_cast<void>(fixture.connection.feed(script.bytes(script.byte()), fixture.now));
            fixture.run();
            break;
        case 1:
            fixture.send_body(script.bytes(script.byte()));
            break;
        case 2:
            fixture.now += std::chrono::seconds{script.byte()};
            fixture.server.handle_deadline(fixture.now);
            fixture.connection.handle_deadline(fixture.now);
            fixture.run();
            break;
        default:
            send_request(fixture, script);
        }
        fixture.responses.clear();
    }
    return 0;
}

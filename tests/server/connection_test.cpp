#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <deque>

#include "support/slow_server.hpp"

namespace connection_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

TEST_CASE("a peer that takes nothing is not worked for, and closed in the end")
{
    auto config = SlowFixture::insecure_config();
    config.limits.max_send_queue = 20'000;
    SlowFixture fixture{std::move(config)};
    auto client = fixture.log_in();
    const NodeId status{0, id::Server_ServerStatus};
    std::vector<std::byte> requests;
    for (int i = 0; i < 100; ++i) {
        ReadRequest request = SlowFixture::read(status, 10);
        request.request_header.authentication_token = client.authentication_token;
        REQUIRE(client.channel.send([&](binary::Writer& writer) {
            encode(writer, NodeId{0, ReadRequest::binary_encoding_id});
            encode(writer, request);
        }));
    }
    requests = take_output(client.channel);
    REQUIRE(client.connection.feed(requests, fixture.now));
    CHECK(client.connection.output().size() < 20'000);
    SECTION("when it reads on, everything is answered")
    {
        client.run();
        CHECK(client.messages.size() == 100);
    }
    SECTION("when it never does, the connection ends")
    {
        fixture.advance(29s);
        client.connection.handle_deadline(fixture.now);
        CHECK_FALSE(client.is_closed());
        fixture.advance(1s);
        client.connection.handle_deadline(fixture.now);
        CHECK(client.is_closed());
        CHECK(client.connection.output().empty());
    }
}

TEST_CASE("connections without a session end")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    fixture.advance(29s, client);
    CHECK_FALSE(client.is_closed());
    SECTION("without")
    {
        fixture.advance(1s, client);
        CHECK(client.is_closed());
        CHECK(client.connection.next_event()->kind == server::ConnectionEvent::Kind::Opened);
        const auto closed = client.connection.next_event();
        REQUIRE(closed);
        CHECK(closed->kind == server::ConnectionEvent::Kind::Closed);
        CHECK(closed->status == status::Bad_Timeout);
        CHECK_FALSE(client.connection.next_event());
    }
    SECTION("with")
    {
        REQUIRE(client.open_session() == status::Good);
        fixture.advance(1s, client);
        CHECK_FALSE(client.is_closed());
    }
}

TEST_CASE("connections are limited, and the oldest without a session gives way")
{
    auto config = ServerFixture::insecure_config();
    config.limits.max_connections = 2;
    config.limits.max_connections_per_address = 2;
    ServerFixture fixture{std::move(config)};
    auto user = fixture.log_in();
    {
        auto second = fixture.log_in();
        CHECK(fixture.server.connect("192.0.2.1", fixture.now).error() ==
              status::Bad_TcpServerTooBusy); // too many from there
    }
    auto idle = fixture.connect();
    auto next = fixture.connect({}, client_identity(), "192.0.2.2");
    CHECK(idle.is_closed());
    CHECK(fixture.server.next_changed() == idle.connection.id());
    CHECK_FALSE(next.is_closed());
    REQUIRE(next.open_session() == status::Good);
    CHECK(fixture.server.connect("192.0.2.3", fixture.now).error() == status::Bad_TcpServerTooBusy);
    CHECK(user.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
}

TEST_CASE("at the limit of an address its oldest connection without a session gives way")
{
    auto config = ServerFixture::insecure_config();
    config.limits.max_connections_per_address = 3;
    ServerFixture fixture{std::move(config)};
    auto user = fixture.log_in();
    auto silent = fixture.server.connect("192.0.2.1", fixture.now).value();
    auto open = fixture.connect(); // a channel and no session
    auto next = fixture.log_in();
    CHECK(silent.is_closed());
    CHECK_FALSE(open.is_closed());
    auto last = fixture.log_in();
    CHECK(open.is_closed());
    CHECK(fixture.log.text.find("a connection from 192.0.2.1 takes the place of this one") !=
          std::string::npos);
    // Nobody with a session gives way.
    CHECK(fixture.server.connect("192.0.2.1", fixture.now).error() == status::Bad_TcpServerTooBusy);
    CHECK(user.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
    CHECK(next.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
}

TEST_CASE("sixty silent sockets keep nobody behind their address out")
{
    ServerFixture fixture;
    std::deque<server::Connection> silent;
    for (int i = 0; i < 200; ++i) {
        auto made = fixture.server.connect("192.0.2.1", fixture.now);
        REQUIRE(made);
        silent.push_back(*std::move(made));
        if (silent.size() > 60) {
            CHECK(silent.front().is_closed());
            silent.pop_front(); // as whoever drives it does
        }
    }
    auto user = fixture.log_in();
    CHECK(user.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
}

TEST_CASE("at the limit of all the network with most connections without a session gives way")
{
    auto config = ServerFixture::insecure_config();
    config.limits.max_connections = 4;
    ServerFixture fixture{std::move(config)};
    auto good = fixture.connect({}, client_identity(), "192.0.2.9"); // the oldest
    std::deque<server::Connection> greedy;
    for (int i = 0; i < 5; ++i) {
        greedy.push_back(fixture.server.connect("192.0.2.66", fixture.now).value());
    }
    CHECK_FALSE(good.is_closed());
    CHECK(greedy[0].is_closed());
    CHECK(greedy[1].is_closed());
    CHECK_FALSE(greedy[2].is_closed());
}

TEST_CASE("shutdown")
{
    SlowFixture fixture;
    auto client = fixture.log_in();
    auto idle = fixture.connect();
    const auto slow = client.send(SlowFixture::slow());
    fixture.server.begin_shutdown(fixture.now, "maintenance");
    CHECK(answer(client, slow) == status::Bad_Shutdown);
    CHECK_FALSE(fixture.server.is_stopped());
    CHECK(idle.create_session().error() == status::Bad_Shutdown);
    CHECK(fixture.server.connect("192.0.2.9", fixture.now).error() == status::Bad_TcpServerTooBusy);

    const NodeId state{0, id::Server_ServerStatus_State};
    const auto read = client.call<ReadResponse>(SlowFixture::read(state));
    REQUIRE(read);
    CHECK(read->results[0].value == Variant{ServerState::Shutdown});
    CHECK(fixture.server.next_deadline() == fixture.now + 2s);
    fixture.advance(2s);
    CHECK(client.is_closed());
    CHECK(idle.is_closed());
    client.run();
    idle.run();
    CHECK(fixture.server.is_stopped());
    CHECK(fixture.server.session_count() == 0);
}

TEST_CASE("a server connects to a client that listens", "[unit:Protocol Reverse Connect Server]")
{
    ServerFixture fixture;
    auto connection = fixture.server.connect("192.0.2.1", fixture.now).value();
    REQUIRE(connection.reverse_hello("opc.tcp://localhost:4840"));
    CHECK(connection.output().size() > 8);
    CHECK(connection.output()[0] == std::byte{'R'});
}

TEST_CASE("a connection to a client waits for it as long as it has no use for it")
{
    ServerFixture fixture;
    auto connection = fixture.server.connect("192.0.2.1", fixture.now).value();
    REQUIRE(connection.reverse_hello("opc.tcp://localhost:4840"));
    connection.consume(connection.output().size());
    CHECK(connection.next_deadline() == no_deadline);
    for (int minute = 0; minute < 60; ++minute) {
        fixture.advance(1min);
        connection.handle_deadline(fixture.now);
    }
    CHECK_FALSE(connection.is_closed());
    // From its first byte on it is a client as any other.
    const std::array<std::byte, 1> first{std::byte{'H'}};
    REQUIRE(connection.feed(first, fixture.now));
    CHECK(connection.next_deadline() == fixture.now + 10s);
    fixture.advance(10s);
    connection.handle_deadline(fixture.now);
    CHECK(connection.is_closed());
}

TEST_CASE("it does not matter how the bytes come")
{
    ServerFixture fixture;
    auto client = fixture.log_in(setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt));
    const std::size_t piece = GENERATE(1U, 7U, 100U);
    const auto send = [&] {
        ReadRequest request = SlowFixture::fast();
        request.request_header.authentication_token = client.authentication_token;
        return client.channel.send([&](binary::Writer& writer) {
            encode(writer, NodeId{0, ReadRequest::binary_encoding_id});
            encode(writer, request);
        });
    };
    const auto first = send();
    const auto second = send();
    REQUIRE(second);
    const auto idle = [] {};
    CHECK(carry(client.channel, client.connection, fixture.now, piece, idle));
    CHECK(answer(client, *first) == status::Good);
    CHECK(answer(client, *second) == status::Good);
}

TEST_CASE("many failures leave a bounded log")
{
    auto config = ServerFixture::insecure_config();
    config.limits.max_log_lines_per_minute = 10;
    ServerFixture fixture{std::move(config)};
    for (int i = 0; i < 50; ++i) {
        auto client = fixture.connect();
        REQUIRE(client.create_session());
        REQUIRE(client.close_session() == status::Good);
    }
    const auto lines = [&] {
        return std::count(fixture.log.text.begin(), fixture.log.text.end(), '\n');
    };
    CHECK(lines() == 10);
    fixture.advance(60s);
    auto client = fixture.log_in();
    CHECK(fixture.log.text.find("90 lines were left out") != std::string::npos);
}

} // namespace connection_test

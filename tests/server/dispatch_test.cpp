#include <catch2/catch.hpp>

#include <algorithm>
#include <deque>

#include <busbar/server/data_source.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "support/server_fixture.hpp"

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

class CountingWaker final : public server::Waker {
public:
    void wake() override { ++count; }
    int count{0};
};

/// Keeps its batches until the test answers them.
class SlowSource final : public server::DataSource {
public:
    void read(server::ReadBatch batch) override { batches.push_back(std::move(batch)); }
    void answer()
    {
        for (auto& slot : batches.front().results()) {
            slot = DataValue{Variant{42}};
        }
        batches.front().complete();
        batches.pop_front();
    }
    std::deque<server::ReadBatch> batches;
};

/// A server with one variable of a source that takes its time.
struct SlowFixture : ServerFixture {
    explicit SlowFixture(server::ServerConfig config = insecure_config())
        : ServerFixture{waker_, std::move(config)}
    {
        model::NewVariable variable;
        variable.source = server.add_source(source);
        variable.data_type = NodeId{0, id::Int32};
        model::NewNode node;
        node.id = NodeId{1, "slow"};
        node.browse_name = QualifiedName{1, "slow"};
        node.parent = server.address_space().find(id::ObjectsFolder);
        REQUIRE(server.address_space().add_variable(node, variable));
    }
    static ReadRequest read(const NodeId& node, std::size_t times = 1)
    {
        ReadRequest request;
        request.nodes_to_read.resize(times);
        for (ReadValueId& value : request.nodes_to_read) {
            value.node_id = node;
            value.attribute_id = 13;
        }
        return request;
    }
    static ReadRequest slow() { return read(NodeId{1, "slow"}); }
    static ReadRequest fast() { return read(NodeId{0, id::Server_ServerStatus_State}); }

    CountingWaker waker_;
    SlowSource source;
};

StatusCode answer(TestClient& client, std::uint32_t request)
{
    const auto response = client.take<ReadResponse>(request);
    return response ? response->response_header.service_result : response.error();
}

/// A request of any type with an empty body behind its header.
std::uint32_t send_type(TestClient& client, std::uint32_t encoding_id, bool with_header = true)
{
    return client.send_bytes([&](binary::Writer& writer) {
        encode(writer, NodeId{0, encoding_id});
        if (with_header) {
            RequestHeader header;
            header.authentication_token = client.authentication_token;
            header.request_handle = 77;
            encode(writer, header);
        }
    });
}

} // namespace

TEST_CASE("the handle of a request comes back, in faults too")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    CHECK(client.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
    CHECK(client.handle_of_answer == client.last_handle);
    CHECK(client.status_of<ReadResponse>(ReadRequest{}) == status::Bad_NothingToDo);
    CHECK(client.handle_of_answer == client.last_handle);
}

TEST_CASE("services that are not there answer Bad_ServiceUnsupported")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    CHECK(client.status_of<CreateSubscriptionResponse>(CreateSubscriptionRequest{}) ==
          status::Bad_ServiceUnsupported);
    CHECK(client.status_of<PublishResponse>(PublishRequest{}) == status::Bad_ServiceUnsupported);
    for (const std::uint32_t type : {99'999U, ReadValueId::binary_encoding_id}) {
        const auto request = send_type(client, type);
        CHECK(answer(client, request) == status::Bad_ServiceUnsupported);
        CHECK(client.handle_of_answer == 77);
    }
    CHECK(client.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
}

TEST_CASE("what cannot be decoded answers Bad_DecodingError and harms nobody")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    SECTION("truncated request")
    {
        for (const std::uint32_t type :
             {ReadRequest::binary_encoding_id, BrowseRequest::binary_encoding_id}) {
            CHECK(answer(client, send_type(client, type)) == status::Bad_DecodingError);
            CHECK(client.handle_of_answer == 77);
        }
    }
    SECTION("no header")
    {
        CHECK(answer(client, send_type(client, ReadRequest::binary_encoding_id, false)) ==
              status::Bad_DecodingError);
    }
    SECTION("nothing at all")
    {
        const auto request = client.send_bytes([](binary::Writer&) {});
        CHECK(answer(client, request) == status::Bad_DecodingError);
    }
    SECTION("bytes left over")
    {
        const auto request = client.send_bytes([&](binary::Writer& writer) {
            ReadRequest read = SlowFixture::fast();
            read.request_header.authentication_token = client.authentication_token;
            encode(writer, NodeId{0, ReadRequest::binary_encoding_id});
            encode(writer, read);
            writer.number(std::uint8_t{0});
        });
        CHECK(answer(client, request) == status::Bad_DecodingError);
    }
    CHECK(client.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
}

TEST_CASE("a client that sends responses does not speak the protocol")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    send_type(client, ReadResponse::binary_encoding_id);
    CHECK(client.is_closed());
}

TEST_CASE("a response that is larger than the client wants is a fault")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    auto request = client.create_request();
    request.max_response_message_size = 600;
    REQUIRE(client.create_session(request));
    REQUIRE(client.activate(TestClient::anonymous()) == status::Good);
    const NodeId state{0, id::Server_ServerStatus_State};
    CHECK(client.status_of<ReadResponse>(SlowFixture::read(state, 10)) == status::Good);
    CHECK(client.status_of<ReadResponse>(SlowFixture::read(state, 100)) ==
          status::Bad_ResponseTooLarge);
    CHECK(client.status_of<ReadResponse>(SlowFixture::read(state, 10)) == status::Good);
}

TEST_CASE("a slow source blocks nobody, its own client included")
{
    SlowFixture fixture;
    auto client = fixture.log_in();
    auto other = fixture.log_in();
    const auto slow = client.send(SlowFixture::slow());
    CHECK(client.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
    CHECK(other.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
    CHECK(answer(client, slow) == status::Bad_WouldBlock);
    CHECK_FALSE(fixture.server.next_changed());

    fixture.source.answer();
    CHECK(fixture.waker_.count == 1);
    fixture.server.handle_completions(fixture.now);
    CHECK(fixture.server.next_changed() == client.connection.id());
    CHECK_FALSE(fixture.server.next_changed());
    const auto response = client.take<ReadResponse>(slow);
    REQUIRE(response);
    CHECK(response->results[0].value == Variant{42});
}

TEST_CASE("the client's timeout hint ends a request")
{
    SlowFixture fixture;
    auto client = fixture.log_in();
    client.timeout_hint = 1'000;
    const auto slow = client.send(SlowFixture::slow());
    CHECK(client.connection.next_deadline() == fixture.now + 1s);
    fixture.advance(999ms, client);
    CHECK(answer(client, slow) == status::Bad_WouldBlock);
    fixture.advance(1ms, client);
    CHECK(answer(client, slow) == status::Bad_Timeout);
    // What comes late is dropped.
    fixture.source.answer();
    fixture.server.handle_completions(fixture.now);
    client.run();
    CHECK(client.messages.empty());
}

TEST_CASE("Cancel ends the requests with a handle")
{
    SlowFixture fixture;
    auto client = fixture.log_in();
    const auto first = client.send(SlowFixture::slow());
    CancelRequest request;
    request.request_handle = client.last_handle;
    const auto second = client.send(SlowFixture::slow());
    const auto cancelled = client.call<CancelResponse>(request);
    REQUIRE(cancelled);
    CHECK(cancelled->cancel_count == 1);
    CHECK(answer(client, first) == status::Bad_RequestCancelledByClient);
    CHECK(answer(client, second) == status::Bad_WouldBlock);
    CHECK(client.call<CancelResponse>(request)->cancel_count == 0);
    fixture.source.answer();
    fixture.source.answer();
    fixture.server.handle_completions(fixture.now);
    CHECK(answer(client, second) == status::Good);
}

TEST_CASE("what waits ends with the session")
{
    SlowFixture fixture;
    auto client = fixture.log_in();
    const auto slow = client.send(SlowFixture::slow());
    SECTION("closed")
    {
        REQUIRE(client.close_session() == status::Good);
    }
    SECTION("timed out")
    {
        auto idle = fixture.connect(); // so that the connection's own timers play no part
        fixture.advance(60s);
        CHECK(fixture.server.next_changed() == client.connection.id());
    }
    CHECK(answer(client, slow) == status::Bad_SessionClosed);
    fixture.source.answer();
    fixture.server.handle_completions(fixture.now);
    client.run();
    CHECK(client.messages.empty());
}

TEST_CASE("what waits is dropped with the connection, and with the server")
{
    auto fixture = std::make_unique<SlowFixture>();
    {
        auto client = fixture->log_in();
        client.send(SlowFixture::slow());
        SECTION("closed by the client first")
        {
            client.channel.close();
            client.run();
            CHECK(client.is_closed());
        }
    }
    CHECK(fixture->server.connection_count() == 0);
    auto batches = std::move(fixture->source.batches);
    SECTION("completed before")
    {
        batches.front().complete();
        fixture->server.handle_completions(fixture->now);
    }
    fixture.reset();
    batches.clear();
}

TEST_CASE("a client can have only so many requests waiting")
{
    auto config = SlowFixture::insecure_config();
    config.limits.max_pending_requests = 3;
    SlowFixture fixture{std::move(config)};
    auto client = fixture.log_in();
    for (int i = 0; i < 3; ++i) {
        CHECK(answer(client, client.send(SlowFixture::slow())) == status::Bad_WouldBlock);
    }
    CHECK(answer(client, client.send(SlowFixture::slow())) == status::Bad_ServerTooBusy);
    fixture.source.answer();
    fixture.server.handle_completions(fixture.now);
    CHECK(answer(client, client.send(SlowFixture::slow())) == status::Bad_WouldBlock);
}

TEST_CASE("what waits is charged to the session")
{
    auto config = SlowFixture::insecure_config();
    config.limits.max_session_memory = 4'000;
    SlowFixture fixture{std::move(config)};
    auto client = fixture.log_in();
    int waiting = 0;
    StatusCode last = status::Bad_WouldBlock;
    while (last == status::Bad_WouldBlock && waiting < 100) {
        last = answer(client, client.send(SlowFixture::slow()));
        ++waiting;
    }
    CHECK(last == status::Bad_TooManyOperations);
    CHECK(waiting > 2);
    while (!fixture.source.batches.empty()) {
        fixture.source.answer();
    }
    fixture.server.handle_completions(fixture.now);
    // Everything was given back.
    for (int i = 1; i < waiting; ++i) {
        CHECK(answer(client, client.send(SlowFixture::slow())) == status::Bad_WouldBlock);
    }
}

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
    auto idle = fixture.connect();
    CHECK(fixture.server.connect("192.0.2.1", fixture.now).error() ==
          status::Bad_TcpServerTooBusy); // too many from there
    auto next = fixture.connect({}, client_identity(), "192.0.2.2");
    CHECK(idle.is_closed());
    CHECK(fixture.server.next_changed() == idle.connection.id());
    CHECK_FALSE(next.is_closed());
    REQUIRE(next.open_session() == status::Good);
    CHECK(fixture.server.connect("192.0.2.3", fixture.now).error() == status::Bad_TcpServerTooBusy);
    CHECK(user.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
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

TEST_CASE("a server connects to a client that listens")
{
    ServerFixture fixture;
    auto connection = fixture.server.connect("192.0.2.1", fixture.now).value();
    REQUIRE(connection.reverse_hello("opc.tcp://localhost:4840"));
    CHECK(connection.output().size() > 8);
    CHECK(connection.output()[0] == std::byte{'R'});
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

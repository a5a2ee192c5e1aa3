#include <catch2/catch.hpp>

#include "support/slow_server.hpp"

namespace operation_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

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
    CHECK(fixture.waker_of_test.count == 1);
    fixture.server.handle_completions(fixture.now);
    CHECK(fixture.server.next_changed() == client.connection.id());
    CHECK_FALSE(fixture.server.next_changed());
    const auto response = client.take<ReadResponse>(slow);
    REQUIRE(response);
    CHECK(response->results[0].value == Variant{42});
}

TEST_CASE("the client's timeout hint ends a request", "[unit:Session General Service Behaviour]")
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

TEST_CASE("what a late source is to write outlives the request")
{
    struct LateWriter final : server::DataSource {
        void read(server::ReadBatch) override {}
        void write(server::WriteBatch batch) override { batches.push_back(std::move(batch)); }
        std::vector<server::WriteBatch> batches;
    };
    LateWriter writer;
    SlowFixture fixture;
    model::NewVariable variable;
    variable.source = fixture.server.add_source(writer);
    variable.data_type = NodeId{0, id::String};
    variable.access_level = model::Access::ReadWrite;
    model::NewNode node;
    node.id = NodeId{1, "text"};
    node.browse_name = QualifiedName{1, "text"};
    node.parent = fixture.server.address_space().find(id::ObjectsFolder);
    REQUIRE(fixture.server.address_space().add_variable(node, variable));
    fixture.users.everybody.access_level_mask = 0xFF;
    auto client = fixture.log_in();
    client.timeout_hint = 1'000;
    const String text{"a text that lies in the message of its request and nowhere else"};
    WriteRequest request;
    request.nodes_to_write.resize(1);
    request.nodes_to_write[0].node_id = node.id;
    request.nodes_to_write[0].attribute_id = 13;
    request.nodes_to_write[0].value.value = text;
    const auto late = client.send(request);
    fixture.advance(1s, client);
    CHECK(answer(client, late) == status::Bad_Timeout);
    client.timeout_hint = 0;
    // Another request, as long and of other bytes.
    request.nodes_to_write[0].node_id = NodeId{1, "none"};
    request.nodes_to_write[0].value.value = String{std::string(text.size(), 'x')};
    CHECK(client.status_of<WriteResponse>(request) == status::Good);
    REQUIRE(writer.batches.size() == 1);
    CHECK(writer.batches[0].items()[0].data->value == Variant{text});
    writer.batches.clear();
    fixture.server.handle_completions(fixture.now);
    client.run();
    CHECK(client.messages.empty());
}

TEST_CASE("Cancel ends the requests with a handle", "[unit:Session Cancel]")
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

TEST_CASE("a session that moves on gets back what its old connection held")
{
    auto config = SlowFixture::insecure_config();
    config.limits.max_session_memory = 1'000;
    SlowFixture fixture{std::move(config)};
    auto client = fixture.connect();
    for (int i = 0; i < 10; ++i) {
        if (i == 0) {
            REQUIRE(client.open_session() == status::Good);
        } else {
            auto next = fixture.connect();
            next.adopt(client);
            REQUIRE(next.activate(TestClient::anonymous()) == status::Good);
            client = std::move(next); // the old connection ends with a request waiting
        }
        CHECK(answer(client, client.send(SlowFixture::slow())) == status::Bad_WouldBlock);
    }
}

} // namespace operation_test

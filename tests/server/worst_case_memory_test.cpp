#include <catch2/catch.hpp>

#include <list>
#include <string>

#include <busbar/types/view.hpp>

#include "memory_growth.hpp"
#include "support/slow_server.hpp"

namespace worst_case_memory_test {

using namespace busbar;
using namespace busbar::test;

/// Each container that a peer can fill is filled here, and what it took then compared with its row.
/// The clients are in the same program: what they hold counts too, which makes it harder.
namespace {

server::ServerConfig small_config()
{
    server::ServerConfig config = ServerFixture::insecure_config();
    config.limits = server::small_controller_limits();
    config.limits.max_sessions_per_user = config.limits.max_sessions; // all of one here
    return config;
}

const std::initializer_list<std::string_view> connection_rows{
    "max_connections", "transport.receive_buffer_size", "transport.max_message_size",
    "max_send_queue"};
/// While one request is served.
const std::initializer_list<std::string_view> request_rows{
    "transport.max_message_size", "decode.max_expansion", "decode.free_memory",
    "max_session_memory"};

CreateSessionRequest wordy_session(const TestClient& client)
{
    const std::string text(2'000, 't');
    auto request = client.create_request();
    request.session_name = text;
    request.client_description.product_uri = text;
    request.client_description.gateway_server_uri = text;
    request.client_description.application_name = LocalizedText{text, text};
    return request;
}

StatusCode activate_with_locales(TestClient& client, std::size_t count)
{
    ActivateSessionRequest request;
    request.user_identity_token = TestClient::anonymous();
    for (std::size_t i = 0; i < count; ++i) {
        request.locale_ids.push_back(String{std::string(32, 'l')});
    }
    return client.status_of<ActivateSessionResponse>(request);
}

} // namespace

TEST_CASE("memory of connections and sessions")
{
    const server::ServerConfig config = small_config();
    const server::ServerLimits& limits = config.limits;
    ServerFixture fixture{config};
    REQUIRE(fixture.log_in().close_session() == status::Good); // what is made once
    std::list<TestClient> clients;
    const Growth growth;
    for (std::size_t i = 0; i < limits.max_connections; ++i) {
        clients.push_back(fixture.connect());
    }
    CHECK(growth.now() >= limits.max_connections * sizeof(TestClient));
    CHECK(growth.now() <= rows(limits, connection_rows));

    const Growth of_sessions;
    for (TestClient& client : clients) {
        REQUIRE(client.create_session(wordy_session(client)));
        REQUIRE(activate_with_locales(client, 100) == status::Good);
    }
    CHECK(fixture.server.session_count() == limits.max_sessions);
    CHECK_FALSE(fixture.server.connect("192.0.2.9", fixture.now));
    CHECK(of_sessions.now() >= limits.max_sessions * 1'000);
    CHECK(of_sessions.now() <=
          rows(limits, {"max_sessions", "max_locale_ids"}) + limits.max_sessions * of_client / 4);
}

TEST_CASE("memory of a peer that takes no answers")
{
    const server::ServerConfig config = small_config();
    ServerFixture fixture{config};
    auto client = fixture.log_in();
    const Growth growth;
    ReadRequest request = SlowFixture::read(NodeId{0, id::Server_NamespaceArray}, 200);
    request.request_header.authentication_token = client.authentication_token;
    for (int sent = 0;
         sent < 100 && client.connection.output().size() <= config.limits.max_send_queue / 2;
         ++sent) {
        REQUIRE(client.channel.send([&](binary::Writer& writer) {
            encode(writer, NodeId{0, ReadRequest::binary_encoding_id});
            encode(writer, request);
        }));
        const auto bytes = take_output(client.channel);
        static_cast<void>(client.connection.feed(bytes, fixture.now));
        while (client.connection.has_enough()) {
            client.connection.handle_deadline(fixture.now);
        }
    }
    CHECK(client.connection.output().size() > config.limits.max_send_queue / 2);
    const std::size_t of_one =
        rows(config.limits, {"max_send_queue"}) / (2 * config.limits.max_connections + 1);
    CHECK(growth.now() <= of_one + of_client);
}

TEST_CASE("memory of unfinished messages")
{
    const server::ServerConfig config = small_config();
    ServerFixture fixture{config};
    std::list<TestClient> clients;
    for (std::size_t i = 0; i < config.limits.max_connections; ++i) {
        clients.push_back(fixture.log_in());
    }
    const Growth growth;
    const std::vector<std::byte> body(40'000);
    for (TestClient& client : clients) {
        REQUIRE(client.channel.send([&](binary::Writer& writer) { writer.bytes(body); }));
        const auto bytes = take_output(client.channel);
        static_cast<void>(client.connection.feed(std::span{bytes}.first(bytes.size() - 1),
                                                 fixture.now)); // the last byte never comes
    }
    CHECK(growth.now() >= config.limits.max_assembly / 2);
    CHECK(growth.now() <= rows(config.limits, {"max_assembly"}) +
                              rows(config.limits, {"transport.receive_buffer_size"}) +
                              clients.size() * of_client);
}

TEST_CASE("memory of requests that wait")
{
    server::ServerConfig config = small_config();
    config.limits.transport.max_message_size = 256U << 10U;
    config.limits.max_pending_requests = 50;
    const server::ServerLimits& limits = config.limits;
    SlowFixture fixture{config};
    auto client = fixture.log_in();
    SECTION("with all that the session can pay for")
    {
        const Growth growth;
        StatusCode last = status::Bad_WouldBlock;
        std::size_t waiting = 0;
        while (last == status::Bad_WouldBlock && waiting < limits.max_pending_requests) {
            last = answer(client, client.send(SlowFixture::read(NodeId{1, "slow"}, 100)));
            waiting += last == status::Bad_WouldBlock ? 1U : 0U;
        }
        CHECK(last == status::Bad_TooManyOperations);
        CHECK(waiting >= 2);
        CHECK(growth.now() >= limits.max_session_memory / 4);
        CHECK(growth.now() <= limits.max_session_memory +
                                  rows(limits, {"max_pending_requests"}) / limits.max_connections +
                                  of_client);
    }
    SECTION("as many as there may be")
    {
        const Growth growth;
        std::size_t waiting = 0;
        while (answer(client, client.send(SlowFixture::slow())) == status::Bad_WouldBlock) {
            ++waiting;
        }
        CHECK(waiting == limits.max_pending_requests);
        CHECK(growth.now() <= rows(limits, {"max_pending_requests"}) / limits.max_connections +
                                  limits.max_session_memory / 4 + of_client);
    }
    while (!fixture.source.batches.empty()) {
        fixture.source.answer();
    }
}

TEST_CASE("memory while a request is served")
{
    const server::ServerConfig config = small_config();
    const server::ServerLimits& limits = config.limits;
    ServerFixture fixture{config};
    auto client = fixture.log_in();
    const auto peak_of = [&](const auto& request, const char* row) {
        const Growth growth;
        client.send(request);
        client.messages.clear();
        CHECK(growth.peak() > 1'000);
        CHECK(growth.peak() <= rows(limits, {row}) + rows(limits, request_rows) + of_client);
    };
    SECTION("Read")
    {
        peak_of(SlowFixture::read(NodeId{0, id::Server_NamespaceArray},
                                  limits.operations.max_nodes_per_read),
                "operations.max_nodes_per_read");
    }
    SECTION("Write")
    {
        WriteRequest request;
        request.nodes_to_write.resize(limits.operations.max_nodes_per_write);
        for (WriteValue& value : request.nodes_to_write) {
            value.node_id = NodeId{0, id::Server_NamespaceArray};
            value.attribute_id = 13;
            value.value.value = Variant{String{std::string(50, 'x')}};
        }
        peak_of(request, "operations.max_nodes_per_write");
    }
    SECTION("Browse")
    {
        BrowseRequest request;
        request.nodes_to_browse.resize(limits.operations.max_nodes_per_browse);
        for (BrowseDescription& one : request.nodes_to_browse) {
            one.node_id = NodeId{0, id::BaseObjectType};
            one.browse_direction = BrowseDirection::Both;
            one.result_mask = 0x3F;
        }
        const Growth growth;
        client.send(request);
        for (int turns = 0; turns < 1'000 && client.connection.has_enough(); ++turns) {
            client.connection.handle_deadline(fixture.now);
        }
        CHECK(growth.peak() > 1'000);
        CHECK(growth.peak() <=
              rows(limits, {"operations.max_nodes_per_browse", "max_references_per_node"}) +
                  rows(limits, request_rows) + of_client);
    }
    SECTION("RegisterNodes")
    {
        RegisterNodesRequest request;
        request.nodes_to_register.resize(limits.operations.max_nodes_per_register_nodes);
        for (NodeId& node : request.nodes_to_register) {
            node = NodeId{1, std::string(200, 'n')};
        }
        peak_of(request, "operations.max_nodes_per_register_nodes");
    }
}

// Else 500 bytes on the wire made gigabytes of a long array.
TEST_CASE("a Read of what fits no response stops before it is made")
{
    server::ServerConfig config = small_config();
    ServerFixture fixture{config};
    model::NewNode node;
    node.id = NodeId{1, "long"};
    node.browse_name = QualifiedName{1, "long"};
    node.parent = fixture.server.address_space().find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::String};
    variable.value = Variant{String{std::string(20'000, 'x')}};
    REQUIRE(fixture.server.address_space().add_variable(node, variable));
    auto client = fixture.log_in();
    const auto read = [&](std::size_t times, std::string_view range = {}) {
        ReadRequest request = SlowFixture::read(NodeId{1, "long"}, times);
        for (ReadValueId& id : request.nodes_to_read) {
            id.index_range = String{std::string{range}};
        }
        const auto sent = client.send(request);
        while (client.connection.next_deadline() <= fixture.now) {
            client.connection.handle_deadline(fixture.now);
        }
        const auto response = client.take<ReadResponse>(sent);
        return response ? response->response_header.service_result : response.error();
    };
    CHECK(read(2) == status::Good);
    const Growth growth;
    CHECK(read(500) == status::Bad_ResponseTooLarge);
    CHECK(growth.peak() <= 1'000'000); // and not 10
    // Of many that are cut each takes its part only.
    CHECK(read(500, "0:9") == status::Good);
}

} // namespace worst_case_memory_test

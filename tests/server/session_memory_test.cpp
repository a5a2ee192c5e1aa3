#include <catch2/catch.hpp>

#include <list>
#include <utility>

#include <busbar/types/ids.hpp>
#include <busbar/types/subscription.hpp>

#include "memory_growth.hpp"
#include "session_use.hpp"

namespace session_memory_test {

using namespace busbar;
using namespace busbar::test;

namespace {

/// A server with some clients, of which only what the server does is counted.
class ManyClients : public ServerFixture {
public:
    ManyClients()
    {
        for (int i = 0; i < 10; ++i) {
            clients.push_back(log_in());
        }
        static_cast<void>(ask(clients.front(), large_read(), true));
    }

    [[nodiscard]] static ReadRequest large_read()
    {
        ReadRequest request;
        request.nodes_to_read.resize(1'000);
        for (ReadValueId& item : request.nodes_to_read) {
            item.node_id = NodeId{0, id::Server_NamespaceArray};
            item.attribute_id = 13;
        }
        return request;
    }
    /// Bytes that the server holds more when it has answered, once the peer has taken that or not.
    template <typename Request>
    [[nodiscard]] std::size_t ask(TestClient& client, Request request, bool takes_answer = false)
    {
        request.request_header.authentication_token = client.authentication_token;
        REQUIRE(client.channel.send([&](binary::Writer& writer) {
            encode(writer, NodeId{0, Request::binary_encoding_id});
            encode(writer, request);
        }));
        const auto bytes = take_output(client.channel);
        const Growth growth;
        static_cast<void>(client.connection.feed(bytes, now));
        while (client.connection.has_enough()) {
            client.connection.handle_deadline(now);
        }
        while (takes_answer && !client.connection.output().empty()) {
            client.connection.consume(client.connection.output().size());
        }
        return growth.now();
    }

    std::list<TestClient> clients;
};

} // namespace

TEST_CASE_METHOD(ManyClients, "a session holds nothing of what it was sent and has sent")
{
    for (TestClient& client : clients) {
        CHECK(ask(client, large_read(), true) < 1'000);
    }
}

TEST_CASE_METHOD(ManyClients, "answers that wait for their peers lie in memory of their size")
{
    std::size_t held = 0;
    std::size_t waiting = 0;
    for (TestClient& client : clients) {
        held += ask(client, read_state());
        waiting += client.connection.output().size();
    }
    CHECK(waiting < 10 * 200);
    CHECK(held < 10 * 1'000);
}

TEST_CASE_METHOD(ManyClients, "requests that wait take what they are")
{
    for (TestClient& client : clients) {
        CreateSubscriptionRequest subscription;
        subscription.requested_publishing_interval = 1'000;
        subscription.requested_lifetime_count = 1'000;
        subscription.requested_max_keep_alive_count = 100;
        static_cast<void>(ask(client, subscription, true));
        now += std::chrono::seconds{1};
        server.handle_deadline(now); // the first keep-alive is due
        static_cast<void>(ask(client, PublishRequest{}, true));
        static_cast<void>(ask(client, PublishRequest{}));
        CHECK(ask(client, PublishRequest{}) < 2'000);
        CHECK(client.connection.output().empty());
    }
}

} // namespace session_memory_test

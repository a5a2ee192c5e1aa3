#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/client/client.hpp>
#include <busbar/client/type_cache.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/types/ids.hpp>

#include "support/failing_allocation.hpp"
#include "support/job_list.hpp"
#include "support/server_fixture.hpp"

namespace busbar::test {

using namespace std::chrono_literals;

/// A Client and a server joined by memory; what the Client does is counted.
class ClientWorld {
public:
    ClientWorld()
    {
        add_nodes();
        client.connect(now());
        advance(5s);
    }

    [[nodiscard]] TimePoint now() const { return site.now; }
    [[nodiscard]] bool is_ready() const { return client.state() == client::ClientState::Ready; }
    void advance(Duration time, Duration step = 100ms)
    {
        const TimePoint end = now() + time;
        run();
        while (now() < end) {
            site.advance(std::min<Duration>(step, end - now()));
            if (link) {
                link->handle_deadline(now());
            }
            counted([&] { client.handle_deadline(now()); });
            run();
        }
    }
    /// The connection breaks, and no other is made before is_reachable.
    void cut()
    {
        is_reachable = false;
        link.reset();
        counted([&] { client.disconnected(last_order, status::Bad_ConnectionClosed, now()); });
        run();
    }
    /// Asks by `ask`, and waits for the answer; Bad_WouldBlock if none comes.
    StatusCode ask(const std::function<void(ClientWorld&)>& asked)
    {
        answers.clear();
        try {
            const Counted while_it_works;
            asked(*this);
        } catch (const std::bad_alloc&) {
            run();
            CHECK(answers.empty()); // it was told already
            return status::Bad_OutOfMemory;
        }
        for (int i = 0; i < 300 && answers.empty(); ++i) {
            advance(100ms);
        }
        CHECK(answers.size() == 1);
        return answers.empty() ? StatusCode{status::Bad_WouldBlock} : answers.front();
    }
    void answer(StatusCode status)
    {
        const Uncounted in_test;
        answers.push_back(status);
    }
    template <typename Outcomes>
    void answer_all(const Outcomes& outcomes)
    {
        for (const auto& outcome : outcomes) {
            if (worth(outcome).is_bad()) {
                return answer(worth(outcome));
            }
        }
        answer(status::Good);
    }

    [[nodiscard]] static model::NewNode node(const char* name, model::NodeIndex parent)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = parent;
        return node;
    }

    // These outlive the server.
    SilentWaker no_waker;
    server::MethodTable table;
    ServerFixture site{no_waker, server_config()};
    client::Client client{config(),
                          {.random = &site.random,
                           .wall_clock = &site.wall_clock,
                           .log = &site.log,
                           .validator = &site.validator,
                           .identity = &client_identity()},
                          site.now};
    /// What the client learns of types, in rows that are about them.
    std::optional<client::TypeCache> types;
    /// What came out of the client.
    int thrown{0};
    std::vector<StatusCode> answers;
    bool is_reachable{true};

private:
    [[nodiscard]] static server::ServerConfig server_config()
    {
        server::ServerConfig config = ServerFixture::insecure_config();
        config.limits.subscriptions.max_retransmission_messages = 2;
        return config;
    }
    [[nodiscard]] static client::ClientConfig config()
    {
        client::ClientConfig config;
        config.endpoint_url = "opc.tcp://localhost:4840";
        config.application_uri = "urn:busbar:test:client";
        config.identity = client::AnonymousUser{};
        config.security.allows_none = true;
        return config;
    }
    /// A Variable and a Method, and a tree: plant, left, deep, twin, twin.
    void add_nodes()
    {
        site.users.everybody.access_level_mask = 0xFF;
        model::AddressSpace& space = site.server.address_space();
        const model::NodeIndex objects = space.find(id::ObjectsFolder);
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Int32};
        variable.value = Variant{1};
        variable.access_level = model::Access::ReadWrite;
        REQUIRE(space.add_variable(node("level", objects), variable));
        model::NewMethod method;
        method.source = site.server.add_source(table);
        method.handle = table.add([](server::MethodCall call) { call.succeed(); });
        REQUIRE(space.add_method(node("start", objects), method));
        const auto plant = space.add_folder(node("plant", objects));
        REQUIRE(plant);
        const auto left = space.add_folder(node("left", *plant));
        REQUIRE(left);
        REQUIRE(space.add_variable(node("deep", *left), variable));
        const auto other = space.add_namespace("urn:plant:other");
        REQUIRE(other);
        for (const std::uint16_t index : {std::uint16_t{1}, *other}) {
            model::NewNode twin = node("twin", *plant);
            twin.id = NodeId{index, "twin"};
            twin.browse_name = QualifiedName{index, "twin"};
            REQUIRE(space.add_folder(twin));
        }
    }
    static StatusCode worth(StatusCode outcome) { return outcome; }
    static StatusCode worth(const DataValue& outcome) { return outcome.status; }
    template <typename T>
    static StatusCode worth(const Result<T>& outcome)
    {
        return outcome ? StatusCode{} : outcome.error();
    }
    template <typename T>
    requires requires(const T& outcome) { outcome.status_code; }
    static StatusCode worth(const T& outcome) { return outcome.status_code; }

    template <typename Work>
    void counted(Work work)
    {
        thrown += survives_counted(std::move(work)) ? 0 : 1;
    }
    void run()
    {
        while (step()) {
        }
    }
    bool step()
    {
        bool has_moved = false;
        counted([&] { has_moved = client.poll(now()); });
        if (link) {
            const auto out = client.output();
            const std::vector<std::byte> request{out.begin(), out.end()};
            counted([&] { client.consume(request.size()); });
            static_cast<void>(link->feed(request, now()));
            const auto answer = take_output(*link);
            if (!answer.empty()) {
                counted([&] { static_cast<void>(client.feed(answer, now())); });
            }
            has_moved = has_moved || !request.empty() || !answer.empty();
        }
        std::optional<client::TransportOrder> order;
        counted([&] { order = client.next_order(); });
        if (order) {
            obey(*order);
        }
        return has_moved || order;
    }
    void obey(const client::TransportOrder& order)
    {
        link.reset();
        last_order = order.id;
        if (order.kind == client::TransportOrder::Kind::Open && is_reachable) {
            link = site.server.connect("192.0.2.1", now()).value();
            counted([&] { client.connected(order.id, now()); });
        } else {
            counted([&] { client.disconnected(order.id, status::Bad_ConnectionClosed, now()); });
        }
    }

    std::optional<server::Connection> link;
    std::uint64_t last_order{0};
};

} // namespace busbar::test

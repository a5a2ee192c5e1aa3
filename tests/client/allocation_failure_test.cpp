#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/client/attributes.hpp>
#include <busbar/client/client.hpp>
#include <busbar/client/discovery.hpp>
#include <busbar/client/methods.hpp>
#include <busbar/client/view.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/types/ids.hpp>

#include "support/failing_allocation.hpp"
#include "support/server_fixture.hpp"

/// D3: each request of a client with the k-th of the client's allocations failing, for k = 1, 2,
/// ... until it goes through. Its handler is called once, with Bad_OutOfMemory or because the
/// connection ended, and soon the client answers as ever.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

const NodeId state_node{0, id::Server_ServerStatus_State};

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
    void advance(Duration time)
    {
        const TimePoint end = now() + time;
        run();
        while (now() < end) {
            site.advance(std::min<Duration>(100ms, end - now()));
            if (link) {
                link->handle_deadline(now());
            }
            counted([&] { client.handle_deadline(now()); });
            run();
        }
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

    struct NoWaker final : server::Waker {
        void wake() override {}
    };

    // These outlive the server.
    NoWaker no_waker;
    server::MethodTable table;
    ServerFixture site{no_waker};
    client::Client client{config(),
                          {.random = &site.random,
                           .wall_clock = &site.wall_clock,
                           .log = &site.log,
                           .validator = &site.validator,
                           .identity = &client_identity()},
                          site.now};
    /// What came out of the client.
    int thrown{0};
    std::vector<StatusCode> answers;

private:
    [[nodiscard]] static client::ClientConfig config()
    {
        client::ClientConfig config;
        config.endpoint_url = "opc.tcp://localhost:4840";
        config.application_uri = "urn:busbar:test:client";
        config.identity = client::AnonymousUser{};
        config.security.allows_none = true;
        return config;
    }
    /// A Variable and a Method.
    void add_nodes()
    {
        site.users.everybody.access_level_mask = 0xFF;
        model::NewNode node;
        node.id = NodeId{1, "level"};
        node.browse_name = QualifiedName{1, "level"};
        node.parent = site.server.address_space().find(id::ObjectsFolder);
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Int32};
        variable.value = Variant{1};
        variable.access_level = model::Access::ReadWrite;
        REQUIRE(site.server.address_space().add_variable(node, variable));
        node.id = NodeId{1, "start"};
        node.browse_name = QualifiedName{1, "start"};
        model::NewMethod method;
        method.source = site.server.add_source(table);
        method.handle = table.add([](server::MethodCall call) { call.succeed(); });
        REQUIRE(site.server.address_space().add_method(node, method));
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
        try {
            const Counted while_it_works;
            work();
        } catch (const std::bad_alloc&) {
            ++thrown;
        }
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
        if (order.kind == client::TransportOrder::Kind::Open) {
            link = site.server.connect("192.0.2.1", now()).value();
            counted([&] { client.connected(order.id, now()); });
        } else {
            counted([&] { client.disconnected(order.id, status::Bad_ConnectionClosed, now()); });
        }
    }

    std::optional<server::Connection> link;
};

struct Row {
    const char* request;
    void (*ask)(ClientWorld&);
};

ReadValueId state_value()
{
    return client::attribute_of(state_node, AttributeId::Value);
}

void call_read(ClientWorld& world)
{
    ReadRequest request;
    request.nodes_to_read = {state_value()};
    world.client.call<ReadResponse>(std::move(request), [&world](const auto& response) {
        world.answer(response ? response->response_header.service_result : response.error());
    });
}

void read(ClientWorld& world)
{
    client::ServiceOptions options;
    options.max_items_per_request = 1;
    options.max_parallel = 1;
    client::read(
        world.client, std::vector<ReadValueId>{state_value(), state_value(), state_value()},
        [&world](std::vector<DataValue> values) { world.answer_all(values); }, {}, options);
}

void write(ClientWorld& world)
{
    client::write(world.client, {client::value_for(NodeId{1, "level"}, DataValue{Variant{7}})},
                  [&world](const auto& results) { world.answer_all(results); });
}

void call(ClientWorld& world)
{
    client::call(world.client, {{NodeId{0, id::ObjectsFolder}, NodeId{1, "start"}, {}}},
                 [&world](const auto& results) { world.answer_all(results); });
}

void translate(ClientWorld& world)
{
    BrowsePath path;
    path.starting_node = NodeId{0, id::ObjectsFolder};
    path.relative_path.elements.resize(1);
    path.relative_path.elements[0].include_subtypes = true;
    path.relative_path.elements[0].target_name = QualifiedName{1, "level"};
    client::translate(world.client, {path},
                      [&world](const auto& results) { world.answer_all(results); });
}

void browse(ClientWorld& world)
{
    client::browse(world.client, {client::children_of(NodeId{0, id::ObjectsFolder})},
                   [&world](const auto& results) { world.answer_all(results); });
}

void browse_in_parts(ClientWorld& world)
{
    client::BrowseLimits limits;
    limits.references_per_answer = 1;
    client::browse(
        world.client, {client::children_of(NodeId{0, id::ObjectsFolder})},
        [&world](const auto& results) { world.answer_all(results); }, limits);
}

void find_servers(ClientWorld& world)
{
    client::find_servers(world.client, "opc.tcp://localhost:4840", [&world](const auto& found) {
        world.answer(found ? StatusCode{} : found.error());
    });
}

void register_nodes(ClientWorld& world)
{
    client::register_nodes(world.client, {state_node},
                           [&world](const auto& results) { world.answer_all(results); });
}

void get_endpoints(ClientWorld& world)
{
    client::get_endpoints(world.client, "opc.tcp://localhost:4840", [&world](const auto& found) {
        world.answer(found ? StatusCode{} : found.error());
    });
}

constexpr Row rows[] = {
    {"Read", call_read},
    {"Read in parts", read},
    {"Write", write},
    {"Call", call},
    {"TranslateBrowsePathsToNodeIds", translate},
    {"Browse", browse},
    {"Browse in parts", browse_in_parts},
    {"FindServers", find_servers},
    {"RegisterNodes", register_nodes},
    {"GetEndpoints", get_endpoints},
};

bool fail_once(const Row& row, std::size_t k)
{
    ClientWorld world;
    REQUIRE(world.is_ready());
    fail_allocation(k);
    const StatusCode answer = world.ask(row.ask);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO(row.request << ", allocation " << k << ": " << name(answer) << "\n"
                     << world.site.log.text);
    CHECK(world.thrown == 0);
    if (has_failed) {
        CHECK((answer == status::Good || answer == status::Bad_OutOfMemory ||
               answer == status::Bad_ConnectionClosed));
        world.advance(60s);
        CHECK(world.is_ready());
    }
    CHECK((answer == status::Good || has_failed));
    CHECK(world.ask(row.ask) == status::Good);
    return has_failed;
}

} // namespace

TEST_CASE("D3: an allocation that fails ends one request of a client, or its connection")
{
    for (const Row& row : rows) {
        DYNAMIC_SECTION(row.request)
        {
            std::size_t k = 1;
            while (fail_once(row, k)) {
                k = k < 300 ? k + 1 : k + 7;
            }
        }
    }
}

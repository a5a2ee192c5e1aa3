#include <catch2/catch.hpp>

#include <atomic>
#include <future>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>

#include <busbar/net/blocking_client.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/types/data_types.hpp>

#include "machine.hpp"

namespace handover_test {

// Another server behind the same listeners.

using namespace busbar;
using namespace std::chrono_literals;

namespace {

/// Keeps the batches that it gets.
class LateSource final : public server::DataSource {
public:
    void read(server::ReadBatch batch) override
    {
        held.push_back(std::move(batch));
        asked.set_value();
    }

    std::vector<server::ReadBatch> held;
    std::promise<void> asked;
};

/// A server whose address space says which one it is, in a Variable and in a namespace.
struct Numbered {
    Numbered(const server::ServerConfig& config, const server::ServerEnvironment& environment,
             int number)
        : memory{*environment.wall_clock}, made{std::make_unique<server::Server>(
                                               *server::Server::create(config, environment))}
    {
        made->add_source(memory);
        made->add_source(late);
        model::AddressSpace& space = made->address_space();
        const model::NodeIndex objects = space.find(id::ObjectsFolder);
        for (int i = 0; i < number; ++i) { // its namespace has another index in each
            space_index = *space.add_namespace("urn:busbar:test:" + std::to_string(i));
        }
        REQUIRE(space.add_variable(objects, {space_index, "Which"},
                                   memory.variable(Variant{std::int32_t{number}})));
        REQUIRE(space.add_variable(objects, {space_index, "Late"},
                                   late.variable(0, Variant{std::int32_t{0}})));
    }

    server::MemorySource memory;
    LateSource late;
    std::uint16_t space_index{0};
    std::unique_ptr<server::Server> made;
};

/// A loop on a thread of its own, and the servers that it is given.
struct Plant : test::ClientSurroundings {
    explicit Plant(net::ReverseConnectConfig reverse = {}, bool is_registered = false)
    {
        users.set_anonymous_access(0xFF);
        REQUIRE(loop.connect_to_clients(std::move(reverse)));
        if (is_registered) {
            register_somewhere();
        }
        Numbered& first = make(1);
        thread = std::thread{[this, &first] { loop.run(*first.made); }};
    }
    ~Plant()
    {
        loop.stop();
        thread.join();
    }
    Numbered& make(int number)
    {
        return *servers.emplace_back(std::make_unique<Numbered>(config, server_around, number));
    }
    /// At a discovery server that is not there.
    void register_somewhere()
    {
        net::DiscoveryRegistrationConfig registration;
        registration.settings = net::registration_of(config, {config.endpoint_url});
        client::SecurityWishes wishes;
        wishes.allows_none = true;
        registration.client = client::registration_client("opc.tcp://127.0.0.1:1", wishes,
                                                          config.application_uri, false);
        registration.settings.farewell = 0ms;
        REQUIRE(loop.register_with(registration, environment));
    }
    Configured<void> hand_over(server::Server& next, net::Handover handover)
    {
        std::promise<Configured<void>> done;
        loop.post([&] { done.set_value(loop.hand_over(next, std::move(handover))); });
        return done.get_future().get();
    }
    /// Done, and the server that went is not used any more.
    void replace(server::Server& next)
    {
        std::promise<void> released;
        REQUIRE(hand_over(next, {.reason = "another program", .delay = 0s, .released = [&] {
                                     released.set_value();
                                 }}));
        released.get_future().wait();
    }
    [[nodiscard]] std::string url() const { return "opc.tcp://127.0.0.1:" + std::to_string(port); }

    server::PasswordUsers users;
    net::ServerLoop loop{log};
    std::uint16_t port{*loop.listen("127.0.0.1", 0)};
    server::ServerConfig config{test::server_config(port)};
    server::ServerEnvironment server_around{.random = &random,
                                            .wall_clock = &clock,
                                            .log = &log,
                                            .users = &users,
                                            .waker = &loop.waker()};
    std::vector<std::unique_ptr<Numbered>> servers;
    std::thread thread;
};

struct Guest : test::ClientSurroundings {
    explicit Guest(const std::string& url) : Guest{test::client_config(url)} {}
    explicit Guest(const client::ClientConfig& config) : client{config, environment} {}

    DataValue read(const NodeId& node)
    {
        const auto response = client.call<ReadResponse>(test::read_request(node));
        return response ? response->results[0] : DataValue{response.error()};
    }
    /// The number of the server, by the node that it has there.
    std::int32_t which(const Numbered& server)
    {
        return read(NodeId{server.space_index, "Which"}).value.value_or(std::int32_t{0});
    }
    /// The same, from whichever server it is connected to once that has the node.
    std::int32_t await(const Numbered& server)
    {
        for (;;) {
            if (const auto number = which(server); number != 0) {
                return number;
            }
        }
    }

    net::BlockingClient client;
};

net::Handover told_for_an_hour()
{
    return {.reason = "another program", .delay = 3'600s, .return_time = {123'456'789}};
}

} // namespace

TEST_CASE("clients of a server that is replaced learn why, and others find the next", "[net]")
{
    Plant plant;
    Guest old{plant.url()};
    REQUIRE(old.client.connect());
    CHECK(old.which(*plant.servers[0]) == 1);
    Numbered& next = plant.make(2);
    REQUIRE(plant.hand_over(*next.made, told_for_an_hour()));

    Guest young{plant.url()};
    REQUIRE(young.client.connect());
    CHECK(young.which(next) == 2);
    CHECK(young.read(test::state_node).value.value_or(std::int32_t{-1}) ==
          static_cast<std::int32_t>(ServerState::Running));

    // Still served by the one before, which has no such node.
    CHECK(old.which(*plant.servers[0]) == 1);
    CHECK(old.which(next) == 0);
    CHECK(old.read(test::state_node).value.value_or(std::int32_t{-1}) ==
          static_cast<std::int32_t>(ServerState::Shutdown));
    const Variant reason = old.read(NodeId{0, id::Server_ServerStatus_ShutdownReason}).value;
    CHECK(reason.value_or(LocalizedText{}).text.view() == "another program");
    CHECK(old.read(NodeId{0, id::Server_EstimatedReturnTime}).value ==
          Variant{DateTime{123'456'789}});
}

TEST_CASE("a return time that is not given is when the connections end", "[net]")
{
    Plant plant;
    Guest old{plant.url()};
    REQUIRE(old.client.connect());
    const DateTime before = plant.clock.now();
    REQUIRE(plant.hand_over(*plant.make(2).made, {.reason = "why not", .delay = 3'600s}));
    const auto back = old.read(NodeId{0, id::Server_EstimatedReturnTime}).value;
    CHECK(back.value_or(DateTime{}).ticks >= before.ticks + 3'600 * DateTime::ticks_per_second);
}

TEST_CASE("a client finds the next server by itself, twice", "[net]")
{
    Plant plant;
    Guest guest{plant.url()};
    REQUIRE(guest.client.connect());
    CHECK(guest.which(*plant.servers[0]) == 1);
    for (const int number : {2, 3}) {
        Numbered& next = plant.make(number);
        plant.replace(*next.made);
        plant.servers[static_cast<std::size_t>(number) - 2]->made.reset();
        CHECK(guest.await(next) == number);
    }
}

TEST_CASE("two servers may be on their way out at once", "[net]")
{
    Plant plant;
    Guest first{plant.url()};
    REQUIRE(first.client.connect());
    REQUIRE(plant.hand_over(*plant.make(2).made, told_for_an_hour()));
    Guest second{plant.url()};
    REQUIRE(second.client.connect());
    REQUIRE(plant.hand_over(*plant.make(3).made, told_for_an_hour()));
    Guest third{plant.url()};
    REQUIRE(third.client.connect());
    CHECK(first.which(*plant.servers[0]) == 1);
    CHECK(second.which(*plant.servers[1]) == 2);
    CHECK(third.which(*plant.servers[2]) == 3);
    // The first goes when its last client does.
    first.client.close();
    CHECK(third.which(*plant.servers[2]) == 3);
}

TEST_CASE("nobody is refused a connection while servers change", "[net]")
{
    Plant plant;
    std::atomic<bool> is_over{false};
    std::atomic<int> refused{0};
    std::atomic<int> accepted{0};
    std::thread knocker{[&] {
        asio::io_context context;
        while (!is_over) {
            asio::ip::tcp::socket socket{context};
            std::error_code error;
            socket.connect({asio::ip::make_address("127.0.0.1"), plant.port}, error);
            ++(error ? refused : accepted);
        }
    }};
    for (int number = 2; number < 12; ++number) {
        plant.replace(*plant.make(number).made);
    }
    is_over = true;
    knocker.join();
    CHECK(refused == 0);
    CHECK(accepted > 0);
    Guest guest{plant.url()};
    REQUIRE(guest.client.connect());
    CHECK(guest.which(*plant.servers.back()) == 11);
}

TEST_CASE("a server that may not take over leaves the one before", "[net]")
{
    Plant plant{{}, true};
    Guest guest{plant.url()};
    REQUIRE(guest.client.connect());
    const auto problem = [&](server::Server& next, net::Handover handover) {
        const auto done = plant.hand_over(next, std::move(handover));
        return done ? std::string{} : done.error().where;
    };
    server::ServerConfig wrong = plant.config;
    wrong.endpoints.clear();
    CHECK_FALSE(server::Server::create(wrong, plant.server_around));

    Numbered& next = plant.make(2);
    CHECK(problem(*plant.servers[0]->made, told_for_an_hour()) == "next");
    CHECK(problem(*next.made, {.reason = ""}) == "reason");
    CHECK(problem(*next.made, {.reason = "x", .delay = -1s}) == "delay");
    CHECK(problem(*next.made, {.reason = "x", .delay = 86'401s}) == "delay");
    plant.config.application_uri = "urn:busbar:test:other";
    CHECK(problem(*plant.make(2).made, told_for_an_hour()) == "application_uri");
    Numbered& used = plant.make(2);
    used.made->begin_shutdown({}, "over");
    CHECK(problem(*used.made, told_for_an_hour()) == "next");
    {
        const auto connection = next.made->connect("127.0.0.1", {});
        REQUIRE(connection);
        CHECK(problem(*next.made, told_for_an_hour()) == "next");
    }

    CHECK(guest.which(*plant.servers[0]) == 1);
    CHECK(guest.read(test::state_node).value.value_or(std::int32_t{-1}) ==
          static_cast<std::int32_t>(ServerState::Running));
    CHECK(problem(*next.made, told_for_an_hour()).empty());
}

TEST_CASE("a loop that does not run hands nothing over", "[net]")
{
    test::ClientSurroundings around;
    net::ServerLoop loop{around.log};
    server::PasswordUsers users;
    const server::ServerEnvironment environment{.random = &around.random,
                                                .wall_clock = &around.clock,
                                                .log = &around.log,
                                                .users = &users,
                                                .waker = &loop.waker()};
    auto server = server::Server::create(test::server_config(4840), environment);
    REQUIRE(server);
    const auto done = loop.hand_over(*server, {.reason = "x"});
    REQUIRE_FALSE(done);
    CHECK(done.error().status == status::Bad_InvalidState);
}

TEST_CASE("data that arrives when its server has gone is dropped", "[net]")
{
    Plant plant;
    Numbered& old = *plant.servers[0];
    Guest late{plant.url()};
    REQUIRE(late.client.connect());
    bool is_answered = true;
    std::thread reader{[&] { // without assertions, which are for one thread
        client::RequestOptions options;
        options.timeout = 30s;
        const auto answer = late.client.call<ReadResponse>(
            test::read_request(NodeId{old.space_index, "Late"}), options);
        is_answered = answer.has_value();
    }};
    old.late.asked.get_future().wait();
    plant.replace(*plant.make(2).made);
    old.made.reset();
    for (server::ReadBatch& batch : old.late.held) {
        batch.results()[0] = DataValue{Variant{std::int32_t{7}}};
        batch.complete();
    }
    reader.join();
    CHECK_FALSE(is_answered);
    Guest guest{plant.url()};
    REQUIRE(guest.client.connect());
    CHECK(guest.which(*plant.servers[1]) == 2);
}

TEST_CASE("the next server connects to clients that listen", "[net][reverse]")
{
    auto config = test::client_config("");
    config.is_reverse = true;
    config.server_uri = test::machine_uri;
    Guest guest{config};
    net::ReverseConnectConfig reverse;
    reverse.client_urls = {"opc.tcp://127.0.0.1:" +
                           std::to_string(*guest.client.listen("127.0.0.1", 0))};
    reverse.first_delay = 5ms;
    reverse.longest_delay = 20ms;
    Plant plant{reverse};
    REQUIRE(guest.client.connect());
    CHECK(guest.which(*plant.servers[0]) == 1);
    Numbered& next = plant.make(2);
    plant.replace(*next.made);
    CHECK(guest.await(next) == 2);
}

} // namespace handover_test

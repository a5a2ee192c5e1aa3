#include "server_in_c.hpp"

#include <array>
#include <csignal>
#include <vector>

namespace c_callbacks_test {

// Calls that callbacks of servers and clients may not make, and waits that an interrupt ends.

using busbar::test::ClientInC;
using busbar::test::ServerInC;

namespace {

constexpr busbar_status good = BUSBAR_GOOD;
constexpr busbar_status interrupted = 0x80840000U; // Bad_RequestInterrupted

/// A client without a server that calls all that waits in its callback of states.
struct Impatient {
    Impatient()
    {
        busbar_client_config config;
        busbar_client_config_init(&config);
        config.application.uri = "urn:test:impatient";
        config.url = "opc.tcp://127.0.0.1:9";
        config.least_mode = BUSBAR_MODE_NONE;
        config.request_timeout_ms = 50;
        config.state = [](void* context, int, busbar_status) {
            static_cast<Impatient*>(context)->wait_for_all();
        };
        config.state_context = this;
        REQUIRE(busbar_client_create(&config, &client) == good);
    }
    Impatient(const Impatient&) = delete;
    Impatient& operator=(const Impatient&) = delete;
    ~Impatient() { busbar_client_destroy(client); }

    void wait_for_all()
    {
        const char* const node = "i=2258";
        const busbar_value one = busbar_value_int32(1);
        busbar_data_value value{};
        busbar_status result = good;
        const busbar_reference* references = nullptr;
        std::size_t count = 0;
        for (const busbar_status each :
             {busbar_client_connect(client, 1), busbar_client_disconnect(client),
              busbar_client_poll(client, 0), busbar_client_run(client),
              busbar_client_read(client, &node, 1, &value),
              busbar_client_write(client, &node, &one, 1, &result),
              busbar_client_call(client, node, node, nullptr, 0, nullptr, nullptr),
              busbar_client_browse(client, node, &references, &count)}) {
            answers.push_back(each);
        }
        texts.emplace_back(busbar_client_last_error(client));
    }

    busbar_client* client{nullptr};
    std::vector<busbar_status> answers;
    std::vector<std::string> texts;
};

/// Ends its Subscription with the first value.
struct Once {
    busbar_client* client;
    std::uint32_t subscription{0};
    int calls{0};

    static void take(void* context, std::uint32_t, const busbar_data_value*)
    {
        auto& once = *static_cast<Once*>(context);
        ++once.calls;
        busbar_client_unsubscribe(once.client, once.subscription);
    }
};

/// The Method of a server: fails with a text of its own, then has the server stop.
busbar_status fail_and_stop(void* context, busbar_call*, const busbar_value*, std::size_t,
                            busbar_value* outputs, std::size_t)
{
    auto* const server = static_cast<busbar_server*>(context);
    struct sigaction before {};
    struct sigaction after {};
    sigaction(SIGTERM, nullptr, &before);
    const busbar_status run = busbar_server_run(server, true);
    sigaction(SIGTERM, nullptr, &after);
    const busbar_value one = busbar_value_int32(1);
    outputs[0].as.boolean =
        run == BUSBAR_BAD_INVALID_STATE && before.sa_handler == after.sa_handler &&
        busbar_server_set_value(server, 99, &one, good, 0) == BUSBAR_BAD_NOT_FOUND &&
        std::string{busbar_server_last_error(server)} == "Bad_NotFound";
    busbar_server_stop(server);
    return good;
}

} // namespace

TEST_CASE("a callback of a client in C cannot wait", "[c]")
{
    Impatient impatient;
    CHECK(busbar_client_connect(impatient.client, 30) == BUSBAR_BAD_TIMEOUT);
    CHECK(busbar_client_disconnect(impatient.client) == good);
    CHECK(busbar_client_state(impatient.client) == BUSBAR_CLIENT_CLOSED);
    REQUIRE(impatient.answers.size() >= 16); // it connects, and closes
    for (const busbar_status each : impatient.answers) {
        CHECK(each == interrupted);
    }
    CHECK(impatient.texts.front() == "a callback cannot wait");
}

TEST_CASE("a request of a client in C that fails as a whole gives each result its status", "[c]")
{
    Impatient alone;
    const std::array<const char*, 2> nodes{"ns=2;s=A", "ns=2;s=B"};
    const std::array<busbar_value, 2> values{busbar_value_int32(1), busbar_value_int32(2)};
    std::array<busbar_status, 2> results{good, good};
    std::array<busbar_data_value, 2> read{};
    CHECK(busbar_client_write(alone.client, nodes.data(), values.data(), 2, results.data()) ==
          good);
    CHECK((results[0] & 0x80000000U) != 0);
    CHECK((results[1] & 0x80000000U) != 0);
    REQUIRE(busbar_client_interrupt(alone.client) == good);
    CHECK(busbar_client_write(alone.client, nodes.data(), values.data(), 2, results.data()) ==
          interrupted);
    CHECK(results == std::array{interrupted, interrupted});
    REQUIRE(busbar_client_interrupt(alone.client) == good);
    CHECK(busbar_client_read(alone.client, nodes.data(), 2, read.data()) == interrupted);
    CHECK(read[0].status == interrupted);
    CHECK(read[1].status == interrupted);
    CHECK(busbar_client_read(alone.client, nullptr, 2, read.data()) == BUSBAR_BAD_INVALID_ARGUMENT);
    CHECK(read[1].status == BUSBAR_BAD_INVALID_ARGUMENT);
}

TEST_CASE("an interrupt ends the disconnect of a client in C", "[c]")
{
    ServerInC machine;
    machine.run();
    ClientInC client{machine.url()};
    client.connect();
    REQUIRE(busbar_client_interrupt(client.client) == good);
    CHECK(busbar_client_disconnect(client.client) == interrupted);
    CHECK(busbar_client_disconnect(client.client) == good);
    CHECK(busbar_client_state(client.client) == BUSBAR_CLIENT_CLOSED);
}

TEST_CASE("a Subscription in C that its callback ends calls it no more", "[c]")
{
    ServerInC machine;
    for (const char* const name : {"A", "B", "C"}) {
        const busbar_variable variable = machine.variable(name, busbar_value_int32(1));
        REQUIRE(busbar_server_add_variable(machine.server, &variable, nullptr) == good);
    }
    machine.run();
    ClientInC client{machine.url()};
    client.connect();
    const std::vector<std::vector<const char*>> lists{
        {"ns=2;s=A", "ns=2;s=B", "ns=2;s=C"}, {"ns=2;s=None", "ns=2;s=Neither", "ns=2;s=No"}};
    for (const std::vector<const char*>& nodes : lists) {
        Once once{client.client};
        std::uint32_t item = 0;
        REQUIRE(busbar_client_subscribe(client.client, 10, Once::take, &once, &once.subscription) ==
                good);
        for (const char* const node : nodes) {
            REQUIRE(busbar_client_monitor(client.client, once.subscription, node, 0, 1, &item) ==
                    good);
        }
        for (int i = 0; i < 500 && once.calls == 0; ++i) {
            REQUIRE(busbar_client_poll(client.client, 10) == good);
        }
        REQUIRE(busbar_client_poll(client.client, 50) == good);
        CHECK(once.calls == 1);
    }
}

TEST_CASE("a callback of a server in C leaves signals and the text of poll alone", "[c]")
{
    ServerInC machine;
    const busbar_argument output{"IsRefused", BUSBAR_BOOLEAN, false, nullptr};
    const busbar_node node = machine.node("Stop");
    REQUIRE(busbar_server_add_method(machine.server, &node, nullptr, 0, &output, 1, fail_and_stop,
                                     machine.server) == good);
    REQUIRE(busbar_server_start(machine.server) == good);
    busbar_status polled = good;
    std::thread thread{[&] { polled = busbar_server_poll(machine.server, 60'000); }};
    busbar_status called = good;
    bool is_refused = false;
    {
        ClientInC client{machine.url()};
        const busbar_value* outputs = nullptr;
        std::size_t count = 0;
        called = busbar_client_connect(client.client, 10'000);
        if (called == good) {
            called = busbar_client_call(client.client, "/Objects", "ns=2;s=Stop", nullptr, 0,
                                        &outputs, &count);
        }
        is_refused = count == 1 && outputs[0].as.boolean;
        busbar_server_stop(machine.server);
    }
    thread.join();
    CHECK(called == good);
    CHECK(is_refused);
    CHECK(polled == BUSBAR_BAD_SHUTDOWN);
    CHECK(std::string{busbar_server_last_error(machine.server)} == "Bad_Shutdown");
    // Nor does run take signals for a server that has stopped.
    struct sigaction before {};
    struct sigaction after {};
    sigaction(SIGTERM, nullptr, &before);
    CHECK(busbar_server_run(machine.server, true) == good);
    sigaction(SIGTERM, nullptr, &after);
    CHECK(before.sa_handler == after.sa_handler);
}

} // namespace c_callbacks_test

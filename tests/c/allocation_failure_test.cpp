#include <catch2/catch.hpp>

#include <cstddef>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include <busbar/busbar.h>

#include "support/failing_allocation.hpp"

namespace c_allocation_failure_test {

// Each allocation of each function fails once: the function says so, and nothing is lost.

using namespace busbar::test;

namespace {

busbar_status no_method(void*, busbar_call*, const busbar_value*, std::size_t, busbar_value*,
                        std::size_t)
{
    return BUSBAR_GOOD;
}

busbar_status no_read(void*, busbar_batch*, busbar_read_item*, std::size_t)
{
    return BUSBAR_GOOD;
}

void no_data(void*, std::uint32_t, const busbar_data_value*) {}

/// Everything of one server and one client, each with names of its own in each round.
struct Rounds {
    busbar_server_config server_config{};
    busbar_client_config client_config{};
    const busbar_endpoint open{"None", BUSBAR_MODE_NONE, true, false};
    busbar_server* server{nullptr};
    busbar_client* client{nullptr};
    busbar_structure* structure{nullptr};
    std::uint64_t handle{0};
    std::uint32_t subscription{0};
    double memory[2]{};
    std::string name;

    Rounds()
    {
        busbar_server_config_init(&server_config);
        server_config.application.uri = "urn:test:failing";
        server_config.address = "127.0.0.1";
        server_config.takes_free_port = true;
        server_config.endpoints = &open;
        server_config.endpoint_count = 1;
        busbar_client_config_init(&client_config);
        client_config.application.uri = "urn:test:failing";
        client_config.url = "opc.tcp://127.0.0.1:9";
        client_config.least_mode = BUSBAR_MODE_NONE;
        client_config.request_timeout_ms = 1;
    }
    [[nodiscard]] busbar_node node() const
    {
        busbar_node node{};
        node.name = name.c_str();
        node.namespace_index = 1;
        return node;
    }
};

/// A function under test: it may be called again and again.
struct Entry {
    const char* name;
    std::function<busbar_status(Rounds&)> call;
    /// It may leave a part of a type, which cannot be removed: the next call has another name.
    bool leaves_part{false};
};

busbar_status create_server(Rounds& rounds)
{
    return busbar_server_create(&rounds.server_config, &rounds.server);
}

busbar_status create_client(Rounds& rounds)
{
    return busbar_client_create(&rounds.client_config, &rounds.client);
}

/// Only what a server allocates to begin with fails.
busbar_status create_and_poll(Rounds& rounds)
{
    {
        const Uncounted while_it_is_created;
        create_server(rounds);
    }
    const busbar_status started = busbar_server_start(rounds.server);
    return started != BUSBAR_GOOD ? started : busbar_server_poll(rounds.server, 0);
}

busbar_status add_variable(Rounds& rounds)
{
    busbar_variable variable;
    busbar_variable_init(&variable);
    variable.node = rounds.node();
    variable.value = busbar_value_string("a text that needs memory");
    return busbar_server_add_variable(rounds.server, &variable, &rounds.handle);
}

busbar_status add_image(Rounds& rounds)
{
    const busbar_image_variable variable{
        {rounds.name.c_str(), BUSBAR_DOUBLE, 2, 0, nullptr}, 0, true};
    busbar_image_config config{};
    config.size = sizeof config;
    config.memory = rounds.memory;
    config.memory_size = sizeof rounds.memory;
    config.variables = &variable;
    config.count = 1;
    config.namespace_index = 1;
    busbar_image* image = nullptr;
    return busbar_server_add_image(rounds.server, &config, &image);
}

busbar_status add_structure(Rounds& rounds)
{
    const busbar_field field{"Member", BUSBAR_DOUBLE, 2, 0, nullptr};
    const busbar_node node = rounds.node();
    return busbar_server_add_structure(rounds.server, &node, &field, 1, &rounds.structure);
}

busbar_status pack_and_unpack(Rounds& rounds)
{
    busbar_value value{};
    const busbar_status packed =
        busbar_structure_pack(rounds.structure, rounds.memory, sizeof rounds.memory, &value);
    return packed != BUSBAR_GOOD ? packed
                                 : busbar_structure_unpack(rounds.structure, &value, rounds.memory,
                                                           sizeof rounds.memory);
}

busbar_status add_method(Rounds& rounds)
{
    const busbar_argument argument{"An argument with a long name", BUSBAR_DOUBLE, false, nullptr};
    const busbar_node node = rounds.node();
    return busbar_server_add_method(rounds.server, &node, &argument, 1, &argument, 1, no_method,
                                    nullptr);
}

busbar_status raise_event(Rounds& rounds)
{
    const busbar_event_field field{0, "Message of a long name", busbar_value_double(1)};
    busbar_event event{};
    event.size = sizeof event;
    event.message = "a text that needs memory";
    event.fields = &field;
    event.field_count = 1;
    const busbar_status raised = busbar_server_raise_event(rounds.server, &event);
    return raised == 0x80040000U ? BUSBAR_GOOD : raised; // Bad_ResourceUnavailable: many wait
}

std::vector<Entry> entries()
{
    return {
        {"add_namespace",
         [](Rounds& rounds) {
             std::uint16_t index = 0;
             return busbar_server_add_namespace(rounds.server, rounds.name.c_str(), &index);
         }},
        {"add_object",
         [](Rounds& rounds) {
             const busbar_node node = rounds.node();
             return busbar_server_add_object(rounds.server, &node, nullptr);
         }},
        {"add_object_type",
         [](Rounds& rounds) {
             const busbar_property property{"Property", BUSBAR_DOUBLE, false};
             const busbar_node node = rounds.node();
             return busbar_server_add_object_type(rounds.server, &node, &property, 1);
         },
         true},
        {"add_variable", add_variable},
        {"set_value",
         [](Rounds& rounds) {
             const busbar_value value = busbar_value_string("another text that needs memory");
             return busbar_server_set_value(rounds.server, rounds.handle, &value, 0, 0);
         }},
        {"get_value",
         [](Rounds& rounds) {
             busbar_data_value value{};
             return busbar_server_get_value(rounds.server, rounds.handle, &value);
         }},
        {"add_source",
         [](Rounds& rounds) {
             busbar_source source{};
             source.size = sizeof source;
             source.read = no_read;
             std::uint32_t number = 0;
             return busbar_server_add_source(rounds.server, &source, &number);
         }},
        {"add_structure", add_structure, true},
        {"pack and unpack", pack_and_unpack},
        {"add_image", add_image},
        {"add_method", add_method},
        {"raise_event", raise_event},
        {"stop", [](Rounds& rounds) { return busbar_server_stop(rounds.server); }},
        {"subscribe",
         [](Rounds& rounds) {
             return busbar_client_subscribe(rounds.client, 100, no_data, nullptr,
                                            &rounds.subscription);
         }},
        {"monitor",
         [](Rounds& rounds) {
             std::uint32_t item = 0;
             return busbar_client_monitor(rounds.client, rounds.subscription,
                                          "/Objects/2:A variable with a long name", 10, 1, &item);
         }},
        {"read",
         [](Rounds& rounds) {
             const char* const node = "ns=2;s=A variable with a long name";
             busbar_data_value value{};
             const busbar_status read = busbar_client_read(rounds.client, &node, 1, &value);
             return read == BUSBAR_GOOD ? value.status : read;
         }},
        {"unsubscribe",
         [](Rounds& rounds) {
             const busbar_status removed =
                 busbar_client_unsubscribe(rounds.client, rounds.subscription);
             return removed == BUSBAR_BAD_NOT_FOUND ? BUSBAR_GOOD : removed;
         }},
    };
}

/// Calls the function until none of its allocations fails any more. Returns how many failed.
std::size_t fail_each(const Entry& entry, Rounds& rounds)
{
    std::size_t number = 1;
    for (std::size_t k = 1; k < 20'000; ++k) {
        rounds.name = std::string{entry.name} + " number " + std::to_string(number);
        fail_allocation(k);
        busbar_status status = BUSBAR_GOOD;
        {
            const Counted while_it_works;
            status = entry.call(rounds);
        }
        const bool has_failed = has_allocation_failed();
        fail_allocation(0);
        INFO(entry.name << ", allocation " << k << ": " << busbar_status_name(status));
        if (!has_failed) {
            // What a client without a server says of a request.
            CHECK((status == BUSBAR_GOOD || status == BUSBAR_BAD_TIMEOUT));
            return k - 1;
        }
        // It did without, or it says so; a node that was begun is taken back.
        CHECK((status == BUSBAR_GOOD || status == BUSBAR_BAD_OUT_OF_MEMORY ||
               status == BUSBAR_BAD_TIMEOUT));
        number += status == BUSBAR_GOOD || entry.leaves_part ? 1 : 0;
    }
    FAIL(entry.name << " does not end");
    return 0;
}

/// Creates a handle with each allocation failing once; leaves the last one.
template <typename Create, typename Destroy>
std::size_t fail_creation(Create create, Destroy destroy)
{
    for (std::size_t k = 1; k < 20'000; ++k) {
        fail_allocation(k);
        busbar_status status = BUSBAR_GOOD;
        {
            const Counted while_it_works;
            status = create();
        }
        const bool has_failed = has_allocation_failed();
        fail_allocation(0);
        if (!has_failed) {
            CHECK(status == BUSBAR_GOOD);
            return k - 1;
        }
        destroy();
        INFO("allocation " << k << ": " << busbar_status_name(status));
        CHECK((status == BUSBAR_GOOD || status == BUSBAR_BAD_OUT_OF_MEMORY));
    }
    return 0;
}

/// Fails each allocation of all functions of one server and one client.
void fail_all()
{
    Rounds rounds;
    CHECK(fail_creation([&] { return create_server(rounds); },
                        [&] { busbar_server_destroy(rounds.server); }) > 50);
    busbar_server_destroy(rounds.server);
    CHECK(fail_creation([&] { return create_and_poll(rounds); },
                        [&] { busbar_server_destroy(rounds.server); }) > 5);
    CHECK(fail_creation([&] { return create_client(rounds); },
                        [&] { busbar_client_destroy(rounds.client); }) > 5);
    std::size_t failed = 0;
    for (const Entry& entry : entries()) {
        failed += fail_each(entry, rounds);
    }
    CHECK(failed > 100);
    busbar_client_destroy(rounds.client);
    busbar_server_destroy(rounds.server);
}

} // namespace

TEST_CASE("each allocation of the C interface fails once", "[c]")
{
    fail_all(); // and what the process and the test keep is there
    const std::size_t before = live_allocations();
    fail_all();
    const std::size_t left = live_allocations();
    CHECK(left == before);
}

TEST_CASE("a program with an operator new of its own keeps it", "[c]")
{
    busbar_allocator allocator{};
    allocator.size = sizeof allocator;
    allocator.allocate = [](void*, std::size_t, std::size_t) -> void* { return nullptr; };
    allocator.release = [](void*, void*) {};
    CHECK(busbar_set_allocator(&allocator) == BUSBAR_BAD_NOT_SUPPORTED);
    busbar_memory memory{};
    memory.size = sizeof memory;
    CHECK(busbar_memory_in_use(&memory) == BUSBAR_BAD_NOT_SUPPORTED);
}

} // namespace c_allocation_failure_test
